"""The wing box: lightest sheets for given caps and stringers, reserve factors, mass."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
from jax import lax
from jaxtyping import Array, Bool, Float, Int

from hera_om.physics import buckling
from hera_om.physics.box_contour import BoxShape, box_shape
from hera_om.physics.box_section import box_members
from hera_om.physics.box_smooth import SHARPNESS, log_smooth_max, smooth_max
from hera_om.physics.laminate import bending_stress, compression_stress, flexure, shear_stress
from hera_om.physics.wingbox_criteria import box_state, panel_use, rib_thickness
from hera_om.physics.wingbox_mass import box_mass
from hera_om.physics.wingbox_reserve import reserves
from hera_om.physics.wingbox_types import (
    BoxConcept,
    BoxGeometry,
    BoxLoads,
    BoxModel,
    BoxResult,
    CriticalStress,
    Material,
    box_centre,
    on_sections,
)

ScalarLike = Float[Array, ""] | float | int

# Newton in the logarithm of the thickness: utilisations are close to powers of it, so a handful of steps do.
_MAX_ITERATIONS = 40
_TOLERANCE = 1e-13
_LARGEST_STEP = 0.7
_T_START = 0.004
_T_LOWEST = 1e-5


def _critical(shape: BoxShape, material: Material, concept: BoxConcept) -> CriticalStress:
    """Critical stress at unit thickness: skins between stringers, webs between ribs, ribs between covers."""
    bent, pitch = flexure(material.E, material.nu, material.laminate), concept.stringer_pitch
    height = jnp.stack([shape.h_front, shape.h_rear])[:, None]
    return CriticalStress(
        compression_stress(bent, concept.rib_pitch, pitch),
        shear_stress(bent, concept.rib_pitch, pitch),
        bending_stress(bent, buckling.K_BENDING_SSSS, height),
        shear_stress(bent, concept.rib_pitch, height),
        compression_stress(bent, shape.h_mean, shape.width),
    )


def box_model(
    geometry: BoxGeometry,
    material: Material,
    concept: BoxConcept,
    *,
    loads: BoxLoads,
    A_cap_root: ScalarLike,
    A_stringer_root: ScalarLike,
) -> BoxModel:
    """Everything that does not depend on the thicknesses; arguments as `size_box`."""
    shape = box_shape(
        geometry.chord,
        geometry.thickness_ratio,
        front_spar=concept.front_spar,
        rear_spar=concept.rear_spar,
        tables=geometry.tables,
    )
    members = box_members(
        shape,
        geometry.chord,
        A_cap_root=A_cap_root,
        A_stringer_root=A_stringer_root,
        pitch=concept.stringer_pitch,
    )
    axis = geometry.axis_fraction * geometry.chord
    turned = on_sections(loads, geometry.incidence)
    return BoxModel(shape, members, material, concept, turned, _critical(shape, material, concept), axis)


def _log_use(log_t: Float[Array, "4 n"], model: BoxModel, sharpness: ScalarLike) -> Float[Array, "4 n"]:
    """Logarithm of the governing utilisation of every panel: zero where it is sized."""
    t = jnp.exp(log_t)
    used = [u.reshape(4, -1, t.shape[1]) for u in panel_use(model, box_state(model, t), t)]
    return log_smooth_max(jnp.concatenate(used, axis=1), 1, sharpness)


def _value_and_jacobian(
    x: Float[Array, "4 n"], model: BoxModel, sharpness: ScalarLike
) -> tuple[Float[Array, "4 n"], Float[Array, "n 4 4"]]:
    """`_log_use` and its derivative [n, i, j]: stations do not see each other, so four tangents do."""
    seeds = jnp.eye(4)[:, :, None] * jnp.ones_like(x)

    def push(seed: Float[Array, "4 n"]):
        return jax.jvp(lambda z: _log_use(z, model, sharpness), (x,), (seed,))

    value, columns = jax.vmap(push, out_axes=(None, 0))(seeds)
    return value, jnp.transpose(columns, (2, 1, 0))


def _newton_step(matrix: Float[Array, "n 4 4"], value: Float[Array, "4 n"]) -> Float[Array, "4 n"]:
    """Solution of matrix dx = -value at every station."""
    return -jnp.linalg.solve(matrix, value.T[:, :, None])[:, :, 0].T


class _Search(NamedTuple):
    """State of the Newton iteration."""

    x: Float[Array, "4 n"]
    change: Float[Array, ""]
    matrix: Float[Array, "n 4 4"]
    count: Int[Array, ""]


def _search(model: BoxModel, sharpness: ScalarLike) -> _Search:
    """Root of `_log_use` by Newton steps of limited length; 6 to 10 of them (2000 random loads and areas)."""
    n = model.shape.width.shape[0]
    highest = jnp.log(model.concept.t_max)

    def advance(s: _Search) -> _Search:
        value, matrix = _value_and_jacobian(s.x, model, sharpness)
        step = jnp.clip(_newton_step(matrix, value), -_LARGEST_STEP, _LARGEST_STEP)
        moved = jnp.clip(s.x + step, jnp.log(_T_LOWEST), highest)
        return _Search(moved, jnp.max(jnp.abs(moved - s.x)), matrix, s.count + 1)

    def unfinished(s: _Search) -> Bool[Array, ""]:
        return (s.change > _TOLERANCE) & (s.count < _MAX_ITERATIONS)

    thick = jnp.full((4, n), jnp.log(_T_START))
    start = _Search(thick, jnp.asarray(jnp.inf), jnp.broadcast_to(jnp.eye(4), (n, 4, 4)), jnp.asarray(0))
    return lax.while_loop(unfinished, advance, start)


def solve_thickness(model: BoxModel, sharpness: ScalarLike = SHARPNESS) -> Float[Array, "4 n"]:
    """Thickness at which every panel is just sized by its worst criterion.

    Damped Newton on log u_i(log t_1..4) = 0 per station, outside the derivatives; then two Newton
    steps with the last matrix inside them. The first step makes first derivatives those of the implicit
    function theorem, the second the second ones.

    Args:
        model: the box and its loads.
        sharpness: exponent of the smooth maximum over criteria and cases.

    Returns:
        Thickness of upper skin, lower skin, front web, rear web, m [4, n], never above ``concept.t_max``.
    """
    frozen = jax.tree.map(lambda leaf: lax.stop_gradient(jnp.asarray(leaf)), (model, sharpness))
    found = _search(*frozen)

    def polish(x: Float[Array, "4 n"], _: None) -> tuple[Float[Array, "4 n"], None]:
        return x + _newton_step(found.matrix, _log_use(x, model, sharpness)), None

    root, _ = lax.scan(polish, found.x, length=2)
    return jnp.exp(jnp.minimum(root, jnp.log(model.concept.t_max)))


def evaluate_box(
    model: BoxModel,
    points: Float[Array, "n 3"],
    t: Float[Array, "4 n"],
    *,
    t_rib: Float[Array, "n"] | None = None,
    sharpness: ScalarLike = SHARPNESS,
) -> BoxResult:
    """Utilisation, reserve factors and mass of a box of given thickness: sized, rounded, or anybody's own.

    Args:
        model: the box and its loads.
        points: centre of the box at the stations, m [n, 3].
        t: thickness of upper skin, lower skin, front web, rear web, m [4, n].
        t_rib: thickness of the ribs, m [n]; sized when absent.
        sharpness: exponent of the smooth extremes.

    Returns:
        The result; see `BoxResult`.
    """
    state = box_state(model, t)
    every = panel_use(model, state, t)
    use = jnp.stack([smooth_max(u, (1, 2), sharpness) for u in every], axis=1)
    by_case = jnp.max(jnp.stack([jnp.max(u, axis=1) for u in every[:-1]]), axis=0)
    ribs = rib_thickness(model, state, t, sharpness) if t_rib is None else t_rib
    mass, cg, inertia = box_mass(model, points, t, ribs)
    return BoxResult(
        t_skin_upper=t[0],
        t_skin_lower=t[1],
        t_web_front=t[2],
        t_web_rear=t[3],
        t_rib=ribs,
        stress=state.direct,
        use=use,
        active=jnp.argmax(use, axis=1),
        sizing_case=jnp.argmax(by_case, axis=1),
        worst_excess=jnp.max(smooth_max(use, 1, sharpness), axis=0) - 1.0,
        **reserves(model, state, t, sharpness)._asdict(),
        section=state.section,
        x_shear_centre=state.flow.x_shear_centre,
        mass=mass,
        m_primary=jnp.sum(jnp.stack(mass)),
        cg=cg,
        inertia=inertia,
    )


def size_box(
    geometry: BoxGeometry,
    material: Material,
    concept: BoxConcept,
    *,
    loads: BoxLoads,
    A_cap_root: ScalarLike,
    A_stringer_root: ScalarLike,
    sharpness: ScalarLike = SHARPNESS,
) -> BoxResult:
    """Lightest skins, webs and ribs under LIMIT loads, and the reserve of the given caps and stringers.

    Every sheet is the thinnest that meets von Mises, buckling and minimum gauge with the required reserve
    factor in every case, all sheets of a station solved together since each relieves the others. Caps and
    stringers are checked (RFT, RFC), and thicker skin is not used to repair them: see
    `wingbox_criteria.DIRECT_SHARE`.

    Args:
        geometry: wing at n stations.
        material: moduli and strengths.
        concept: spars, pitches, gauges, reserve factor.
        loads: LIMIT loads [case, n].
        A_cap_root: area of one cap at the first station, m2.
        A_stringer_root: area of one stringer there, m2.
        sharpness: exponent of the smooth maxima.

    Returns:
        The sized box. ``worst_excess`` above 1e-6 at a station: no thickness up to t_max carries the load
        there; ``use`` of that station names panel and criterion.
    """
    model = box_model(geometry, material, concept, loads=loads, A_cap_root=A_cap_root, A_stringer_root=A_stringer_root)
    return evaluate_box(model, box_centre(geometry, concept), solve_thickness(model, sharpness), sharpness=sharpness)
