"""Oscillating lattice: plunge-rate derivatives up and sideways, and symmetric motions of any reduced frequency.

Circulations oscillate as exp(i w t); the wake of a strip carries Gamma_TE(t - xi / V), xi behind the trailing
edge. The lattice goes on into the wake: the circulation of a ring belongs to the collocation point of its
panel, and the first wake vortices stand a quarter of the last panel's chord behind the trailing edge, one such
chord apart, before the wake becomes a sheet. With all of the wake a sheet that begins at the trailing edge the
error falls with the square root of the panel's size only; so it falls with the square.

Loads: Kutta-Joukowski on the filaments and rho dGamma/dt on the panels (Katz & Plotkin, Low-Speed Aerodynamics
2e, chapter 13). At Mach M the potential is exp(i w M^2 x / (beta^2 V)) times a potential of the stretched
steady equation (Miles, On the compressibility correction for subsonic unsteady flow, J. Aeronaut. Sci. 17,
1950); what is left out is of second order in w M / (beta^2 V) times the distance. With it the strength of the
wake lags by x / (beta^2 V). Derivation, checks and limits: docs/theory/unsteady.md.
"""

from collections.abc import Sequence
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Complex, Float, Inexact

from hera_om.physics.geometry import QUARTER, Panels, between
from hera_om.physics.lattice import MIRROR, Lattice, prandtl_glauert, solve
from hera_om.physics.lattice_forces import filament_strengths
from hera_om.physics.layout import Layout
from hera_om.physics.unsteady_kernel import ramp, step

WAKE_LAG = 1.0
"""Share of the wake's lag; 0 leaves a wake that follows the circulation at once."""
COMPRESSIBLE_PHASE = 1.0
"""Share of the phase exp(i w M^2 x / (beta^2 V)); 0 leaves the Prandtl-Glauert rule alone."""
APPARENT_MASS = 1.0
"""Share of the pressure rho dGamma/dt."""
WAKE_VORTICES = 4
"""Discrete vortices between the trailing edge and the sheet. With 1 or 4, the phase of Theodorsen's function at
k = 0.3 is wrong by 0.20 or 0.04 degrees on 8 panels, by 0.09 or 0.01 on 32 (plane flow)."""
PHASE_STEP = 0.12
"""Phase between the points of the wake's strength (rad): linear interpolation loses step^2 / 12 of it."""
FADE = (1.0, 5.0)
"""Wavelengths behind the trailing edge between which the wake of `oscillate` fades out."""

Number = Float[Array, ""] | float


class UnsteadyLoads(NamedTuple):
    """Circulations over flight speed and forces over dynamic pressure of the starboard half.

    Half of the force on a surface in the plane of symmetry belongs to it.
    """

    gamma: Inexact[Array, " n"]  # m
    filaments: Inexact[Array, "e 3"]  # Kutta-Joukowski, at `Lattice.points`, m^2
    added: Inexact[Array, "a 3"]  # apparent mass of panels [n], then trailing edges [s], m^2
    added_points: Float[Array, "a 3"]


def plunge_rate(
    lattice: Lattice,
    surfaces: Sequence[Panels],
    plan: Layout,
    *,
    gamma: Float[Array, " n"],
    gamma_by: Float[Array, " n"],
    velocity: Float[Array, "e 3"],
    mach: Number,
    length: Number,
    odd: bool = False,
) -> UnsteadyLoads:
    """Derivatives by alphadot l / 2V or betadot l / 2V in pure plunging, up or sideways: axes that do not turn.

    To first order in the frequency. With A the steady matrix, W the wash of wakes that grow linearly, Gamma_a the
    circulations' derivatives by the angle, x the places of the collocation points, to which the circulations belong
    as well, and m = M^2 / beta^2,

        A Gamma_1 = (1 + m) W Gamma_a - m (x A - A x) Gamma_a .

    Sideways the flow is reversed by the plane of symmetry: A and W are those of the reversed half.

    The next term is k^2 log k: the derivatives exist in three dimensions only and grow with the logarithm of
    the aspect ratio. Slipstreams act through ``gamma``, ``gamma_by`` and ``velocity``; the wake travels with
    the flight speed. The mean flow is its mirrored part.

    Args:
        lattice: factorised steady lattice; its mirrored half is used, or its reversed one.
        surfaces: panels of all its surfaces.
        plan: layout of its filaments.
        gamma: circulations of the mean flow, m.
        gamma_by: derivatives by the incidence, or by the sideslip, m.
        velocity: local velocity over flight speed at the filaments in the mean flow, own induction included.
        mach: Mach number, below 1.
        length: reference chord, or span, m.
        odd: whether it plunges sideways.

    Returns:
        UnsteadyLoads, each a derivative.
    """
    half, beta = lattice.odd if odd else lattice.even, prandtl_glauert(jnp.asarray(mach))
    assert half is not None, "sideways plunging needs the reversed half"
    m = COMPRESSIBLE_PHASE * (mach / beta) ** 2
    n, x = lattice.collocation.shape[0], lattice.collocation[:, 0]
    everywhere = jnp.concatenate([lattice.collocation, lattice.points])
    shed = gamma_by[plan.last] * (plan.weight if odd else 1.0)  # a wake in the plane is its own image
    late = WAKE_LAG * (1.0 + m) * _late_wash(everywhere, surfaces, shed, beta, -1.0 if odd else 1.0)
    needed = jnp.sum(lattice.normal * late[:n], axis=-1) - m * x * (half.matrix @ gamma_by)
    answer = solve(half, needed)
    change = answer + m * x * gamma_by
    wash = half.velocity @ answer + m * lattice.points[:, :1] * (half.velocity @ gamma_by) - late[n:]
    old, new = filament_strengths(plan, gamma), filament_strengths(plan, change, change if odd else None)
    filaments = 2.0 * jnp.cross(new[:, None] * velocity + old[:, None] * wash, lattice.arms)
    areas, points = _impulse(surfaces)
    added = APPARENT_MASS * 2.0 * _owned(gamma_by, plan) * areas
    share = jnp.asarray(plan.weight)[:, None]
    filaments, added = share[plan.inner] * filaments, share[added_strips(plan)] * added
    scale = 2.0 / length
    return UnsteadyLoads(scale * change, scale * filaments, scale * added, points)


def plunging(lattice: Lattice) -> Complex[Array, " n"]:
    """Normal velocity of the air over flight speed at the collocation points, per radian of incidence w / V."""
    return lattice.normal[:, 2] + 0.0j


def pitching(lattice: Lattice, wavenumber: Number, axis: Float[Array, " 3"]) -> Complex[Array, " n"]:
    """The same per radian of pitch angle about ``axis``: incidence, and the rate i w theta."""
    arm = lattice.collocation - axis
    return plunging(lattice) + 1j * wavenumber * (lattice.normal[:, 2] * arm[:, 0] - lattice.normal[:, 0] * arm[:, 2])


def oscillate(
    lattice: Lattice,
    surfaces: Sequence[Panels],
    plan: Layout,
    *,
    wash: Complex[Array, " n"],
    wavenumber: Number,
    mach: Number,
) -> UnsteadyLoads:
    """Complex amplitudes in a motion of any frequency, linear about the stream along x.

    The wake's strength exp(-i w xi / V) is linear between points that lie close in phase, each piece in closed
    form, and fades out smoothly over a few wavelengths. Mean circulation and slipstreams take no part.

    Valid for any frequency at Mach 0. Above, the error is of the order of (w M l / (beta^2 V))^2, where l is the
    distance over which parts of the surfaces matter to each other: at least a chord, at most the span.

    Args:
        lattice: steady lattice; its mirrored half is used.
        surfaces: panels of all its surfaces.
        plan: layout of its filaments.
        wash: amplitude of the air's normal velocity over flight speed, see `plunging` and `pitching`.
        wavenumber: w / V, above 0, 1/m; the reduced frequency is wavenumber c / 2.
        mach: Mach number, below 1.

    Returns:
        UnsteadyLoads.
    """
    beta, iw = prandtl_glauert(jnp.asarray(mach)), 1j * wavenumber
    m = COMPRESSIBLE_PHASE * (mach / beta) ** 2
    lag = _oscillating_wash(lattice.collocation, surfaces, wavenumber * (1.0 + m), beta)
    matrix = (lattice.even.matrix + 0j).at[:, plan.last].add(WAKE_LAG * jnp.einsum("pi,psi->ps", lattice.normal, lag))
    phase = jnp.exp(iw * m * lattice.collocation[:, 0])
    gamma = phase * jnp.linalg.solve(matrix, -wash / phase)
    padded = jnp.append(gamma, 0.0)
    strength = padded[plan.plus] - padded[plan.minus]
    filaments = 2.0 * strength[:, None] * _around(lattice.arms)
    areas, points = _impulse(surfaces)
    return UnsteadyLoads(gamma, filaments, APPARENT_MASS * 2.0 * iw * _owned(gamma, plan) * areas, points)


def unsteady_resultant(
    lattice: Lattice, loads: UnsteadyLoads, reference: Float[Array, " 3"], odd: bool = False
) -> tuple[Inexact[Array, " 3"], Inexact[Array, " 3"]]:
    """Force (m^2) and moment (m^3) about ``reference`` of both halves: y force and x, z moments cancel.

    ``odd``: of reversed flow, where these remain and the others cancel.
    """
    forces = jnp.concatenate([loads.filaments, loads.added])
    arms = jnp.concatenate([lattice.points, loads.added_points]) - reference * jnp.asarray([1.0, 0.0, 1.0])
    keep = jnp.asarray([0.0, 2.0, 0.0] if odd else [2.0, 0.0, 2.0])
    return keep * jnp.sum(forces, axis=0), (2.0 - keep) * jnp.sum(jnp.cross(arms, forces), axis=0)


def _impulse(surfaces: Sequence[Panels]) -> tuple[Array, Array]:
    """Areas of the rings as vectors and their centres, then those of the trailing edges.

    Behind the last collocation points the circulation has the wake's lag, so that nothing is loaded there: a
    negative area, of a quarter of the panel, at the trailing edge.
    """
    areas, points, edge_areas, edge_points = [], [], [], []
    for s in surfaces:
        front, back = s.rings[:-1], s.rings[1:]
        areas.append(jnp.cross(back[:, :-1] - front[:, 1:], back[:, 1:] - front[:, :-1]).reshape(-1, 3) / 2)
        points.append((front[:, :-1] + front[:, 1:] + back[:, :-1] + back[:, 1:]).reshape(-1, 3) / 4)
        edge, chord = s.rings[-1], _last_chord(s)
        middle = (chord[:-1] + chord[1:]) / 2
        edge_areas.append(-QUARTER * middle[:, None] * _around(edge[1:] - edge[:-1]))
        edge_points.append((edge[:-1] + edge[1:]) / 2)
    return jnp.concatenate(areas + edge_areas), jnp.concatenate(points + edge_points)


def added_strips(plan: Layout) -> np.ndarray:
    """Strip of each of the forces `UnsteadyLoads.added`."""
    first = np.cumsum([0, *plan.strips[:-1]])
    parts = zip(plan.counts, plan.strips, first, strict=True)
    return np.concatenate([f + np.arange(n) % k for n, k, f in parts] + [np.arange(sum(plan.strips))])


def _owned(gamma, plan: Layout):
    """Circulations that the areas of `_impulse` belong to."""
    return jnp.concatenate([gamma, gamma[plan.last]])[:, None]


def _around(v):
    """e_x x v: direction of the force of a vortex in the stream along x."""
    return jnp.stack([jnp.zeros_like(v[..., 0]), -v[..., 2], v[..., 1]], axis=-1)


def _last_chord(surface: Panels):
    """Chord of the last row of panels at the trailing nodes."""
    return (surface.rings[-1, :, 0] - surface.rings[-2, :, 0]) / (1 - QUARTER)


class _Wake(NamedTuple):
    """Ends of the wakes' strips of the starboard half."""

    left: Float[Array, "v s 3"]  # of the lines of their vortices and, last, of the fronts of their sheets, m
    right: Float[Array, "v s 3"]
    pitch: Float[Array, " s"]  # distance between the vortices, m


def _wake(surfaces: Sequence[Panels]) -> _Wake:
    """Vortices and sheets behind the trailing edges of all surfaces."""
    places = QUARTER + np.append(np.arange(WAKE_VORTICES), WAKE_VORTICES - 0.5)
    left, right, pitch = [], [], []
    for s in surfaces:
        chord = _last_chord(s)
        lines = s.rings[-1] + places[:, None, None] * chord[:, None] * jnp.asarray([1.0, 0.0, 0.0])
        left.append(lines[:, :-1])
        right.append(lines[:, 1:])
        pitch.append(between(chord[:-1], chord[1:], s.middle))
    return _Wake(jnp.concatenate(left, axis=1), jnp.concatenate(right, axis=1), jnp.concatenate(pitch))


def _both_halves(points, beta, velocity, sign=1.0):
    """Velocities of the starboard wakes and their images (``sign`` -1: in reversed flow).

    ``velocity`` takes points of the stretched space.
    """
    mirror, stretch = jnp.asarray(MIRROR), jnp.stack([1.0 / beta, jnp.ones_like(beta), jnp.ones_like(beta)])
    own, image = jnp.split(velocity(jnp.concatenate([points, points * mirror]) * stretch, stretch) * stretch, 2)
    return own + sign * image * mirror


def _late_wash(
    points, surfaces: Sequence[Panels], strength: Float[Array, " s"], beta, sign: float
) -> Float[Array, "p 3"]:
    """Velocity of wakes whose strength is that of their strip times the distance behind its last circulation."""
    wake = _wake(surfaces)

    def velocity(p, stretch):
        left, right = wake.left * stretch, wake.right * stretch
        jumps = jnp.tile(wake.pitch * strength, WAKE_VORTICES)
        vortices = jnp.einsum("psi,s->pi", step(p, left[:-1].reshape(-1, 3), right[:-1].reshape(-1, 3)), jumps)
        return vortices + jnp.einsum("psi,s->pi", ramp(p, left[-1], right[-1]), beta * strength)

    return _both_halves(points, beta, velocity, sign)


def _oscillating_wash(points, surfaces: Sequence[Panels], lag, beta) -> Complex[Array, "p s 3"]:
    """Velocity that oscillating wakes add to steady ones, per unit circulation; ``lag`` in radians a metre."""
    wake, (places, kinks) = _wake(surfaces), _sheet()
    after = jnp.exp(-1j * lag * wake.pitch * jnp.arange(WAKE_VORTICES + 1)[:, None])

    def velocity(p, stretch):
        left, right = wake.left * stretch, wake.right * stretch
        each = jax.vmap(step, (None, 0, 0))(p, left[:-1], right[:-1])
        vortices = jnp.einsum("vpsi,vs->psi", each, after[1:] - after[:-1])

        def add(total, kink):
            shift = jnp.asarray([1.0, 0.0, 0.0]) * kink[0] / (lag * beta)
            return total + kink[1] * ramp(p - shift, left[-1], right[-1]), None

        sheet, _ = jax.lax.scan(add, jnp.zeros_like(vortices), (places, kinks))
        return vortices + after[-1][:, None] * lag * beta * sheet

    return _both_halves(points, beta, velocity)


def _sheet() -> tuple[Array, Array]:
    """Phases at which the slope of the sheet's strength, less its value at the front, changes; the changes.

    The points are dense at the front, where the strength's error meets the trailing edge.
    """
    steps = np.minimum(PHASE_STEP, 0.005 * 1.2 ** np.arange(int(2 * np.pi * FADE[1] / PHASE_STEP) + 20))
    places = np.append(0.0, np.cumsum(steps))
    part = np.clip((places / (2 * np.pi) - FADE[0]) / (FADE[1] - FADE[0]), 0.0, 1.0)
    strength = np.exp(-1j * places) * (1 - part**3 * (10 - 15 * part + 6 * part**2))
    slopes = np.diff(strength) / steps
    return jnp.asarray(places), jnp.asarray(np.diff(slopes, prepend=0.0, append=0.0))
