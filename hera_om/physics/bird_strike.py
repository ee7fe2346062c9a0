"""Leading edge ahead of the front spar: the gauge that a bird does not pierce, and its mass."""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from hera_om.physics.box_contour import contour_at, naca_tables
from hera_om.physics.wingbox_types import BoxConcept, BoxGeometry, Material

ScalarLike = Float[Array, ""] | float | int

BIRD_MASS = 1.81  # kg, 4 lb at V_C at sea level: CS 25.631
# V = 98 t M^(-1/3) cos(L)^(-0.7) exp(1234 / (r^2 + 30 r + 1000)), mm, kg, m/s: tests of the Royal Aircraft
# Establishment on aluminium leading edges, TR 72056, as the literature quotes it. Not seen in print: weak.
RAE_SPEED, RAE_SWEEP = 98.0, 0.7
RAE_NOSE, RAE_LINEAR, RAE_CONSTANT = 1234.0, 30.0, 1000.0
NOSE_RADIUS = 1.1019  # over chord and squared thickness ratio: Abbott & von Doenhoff, eq. 6.3
_ARC = 0.5 * (1.0 - np.cos(np.linspace(0.0, np.pi, 25)))[1:]


class LeadingEdge(NamedTuple):
    """Gauge at n stations, m, and mass of both sides from joint to tip, kg."""

    t: Float[Array, "n"]
    mass: Float[Array, ""]


def bird_gauge(speed: ScalarLike, radius: Float[Array, "n"], cos_sweep: Float[Array, "n"]) -> Float[Array, "n"]:
    """Thickness of an aluminium nose that a bird of 1.81 kg does not pierce, m; see ``RAE_SPEED``.

    Args:
        speed: of the impact, m/s.
        radius: of the nose, m.
        cos_sweep: cosine of the sweep of the leading edge.
    """
    r = 1e3 * radius
    nose = jnp.exp(RAE_NOSE / (jnp.square(r) + RAE_LINEAR * r + RAE_CONSTANT))
    return 1e-3 * speed * BIRD_MASS ** (1.0 / 3.0) * cos_sweep**RAE_SWEEP / (RAE_SPEED * nose)


def leading_edge(geometry: BoxGeometry, material: Material, concept: BoxConcept, *, speed: ScalarLike) -> LeadingEdge:
    """Skin round the nose from front spar to front spar: the larger of minimum gauge and `bird_gauge`.

    Args:
        geometry: wing at n stations.
        material: its density; the formula is for aluminium.
        concept: front spar and minimum gauge.
        speed: V_C at sea level, m/s.

    Returns:
        Gauge and mass; secondary structure, without ribs and joints of the nose.
    """
    n = geometry.chord.shape[0]
    tables = naca_tables(n) if geometry.tables is None else geometry.tables
    mean, half = contour_at(tables, concept.front_spar * jnp.asarray(_ARC))
    x = jnp.concatenate([jnp.zeros((1, n)), concept.front_spar * jnp.asarray(_ARC)[:, None] * jnp.ones(n)])
    start = jnp.zeros((1, n))
    arc = sum(
        jnp.sum(jnp.hypot(jnp.diff(x, axis=0), jnp.diff(jnp.concatenate([start, mean + s * half]), axis=0)), axis=0)
        for s in (geometry.thickness_ratio, -geometry.thickness_ratio)
    )
    step = jnp.diff(geometry.leading_edge, axis=0)
    length = jnp.linalg.norm(step, axis=1)
    cos_sweep = jnp.sqrt(1.0 - jnp.square(step[:, 0] / length))
    inner = jnp.concatenate([cos_sweep[:1], 0.5 * (cos_sweep[1:] + cos_sweep[:-1]), cos_sweep[-1:]])
    radius = NOSE_RADIUS * geometry.chord * jnp.square(geometry.thickness_ratio)
    t = jnp.maximum(concept.t_min, bird_gauge(speed, radius, inner))
    per_length = material.rho * t * arc * geometry.chord
    return LeadingEdge(t, jnp.sum((per_length[1:] + per_length[:-1]) * length))
