"""Utilisation of skins, webs and ribs by their own criteria: required reserve factor over reserve factor."""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from hera_om.physics import buckling
from hera_om.physics.box_section import Section, ShearFlow, section_properties, shear_flow
from hera_om.physics.box_smooth import positive_part, smooth_below, smooth_max
from hera_om.physics.wingbox_types import BoxModel

ScalarLike = Float[Array, ""] | float | int

# Share of the direct allowable that a sheet's own von Mises criterion charges to bending, at most. Above it
# the sheet would be thickened for the sake of caps and stringers; design.md section 4 forbids that: their
# reserve then falls below 1.5 and says so. 0.9 leaves a shear stress of 0.25 allowable. Design choice.
DIRECT_SHARE = 0.9
# Width of the smooth positive part and minimum, as a share of the allowable: 2.5e-7 of the allowable off
# where the stress is the allowable, 5e-4 where it is zero.
SMOOTH_WIDTH = 1e-3


class BoxState(NamedTuple):
    """Stresses at given thickness, tension positive, Pa, with the section they come from."""

    section: Section
    flow: ShearFlow
    cover_direct: Float[Array, "2 case n"]
    """Upper and lower extreme fibre."""
    cover_shear: Float[Array, "2 2 case n"]
    """Upper and lower cover at their front and rear end."""
    web_direct: Float[Array, "2 case n"]
    """Front and rear web, at the edge farther from the neutral axis; of either sign."""
    web_shear: Float[Array, "2 2 case n"]
    """Front and rear web: edge, peak."""


def box_state(model: BoxModel, t: Float[Array, "4 n"]) -> BoxState:
    """Stresses of the box at thickness t: engineer's bending, shear flow, Bredt's torsion.

    sigma = -M z / I; q = V q_unit + T_sc / (2 A), with the torque moved to the shear centre, T_sc = T + V
    (x_sc - x_axis).

    Args:
        model: shape, members, loads.
        t: thickness of upper skin, lower skin, front web, rear web, m [4, n].

    Returns:
        Stresses for every load case.
    """
    shape, loads = model.shape, model.loads
    section = section_properties(shape, model.members, t)
    flow = shear_flow(shape, section, t)
    bend = loads.M / section.inertia
    z_c = section.z_centroid
    torque = loads.T + loads.V * (flow.x_shear_centre - model.axis_from_front)
    bredt = torque / (2.0 * shape.enclosed)
    web_arm = 0.5 * jnp.stack([shape.h_front, shape.h_rear]) + jnp.sqrt(jnp.square(z_c) + 1e-12)
    web_flow = jnp.stack([flow.web_edge, flow.web_peak], axis=1)
    return BoxState(
        section,
        flow,
        jnp.stack([-bend * (shape.z_max - z_c), bend * (shape.z_max + z_c)]),
        (flow.covers[:, :, None] * loads.V + bredt) / t[:2, None, None],
        bend * web_arm[:, None],
        (web_flow[:, :, None] * loads.V + bredt) / t[2:, None, None],
    )


def _direct_share(stress: Float[Array, "..."], allowable: ScalarLike, reserve: ScalarLike) -> Float[Array, "..."]:
    """Positive direct stress over its allowable, at most ``DIRECT_SHARE`` of 1 / reserve."""
    share = positive_part(stress / allowable, SMOOTH_WIDTH)
    return smooth_below(share, DIRECT_SHARE / reserve, SMOOTH_WIDTH)


def _von_mises_use(
    direct: Float[Array, "4 a n"], shear: Float[Array, "4 a n"], model: BoxModel
) -> Float[Array, "4 b n"]:
    """Utilisation in von Mises stress, tension against F_tu and compression against F_cy, along axis 1.

    s^2 + 3 tau^2 = (F / RF)^2 is asked as sqrt(3) tau over the sqrt((F / RF)^2 - s^2) left to it: one at
    the same thickness, but never flat where bending takes most of the allowable, which Newton's method
    would not stand.
    """
    material, reserve = model.material, model.concept.reserve
    pulled = _direct_share(direct, material.F_tu, reserve)
    pressed = _direct_share(-direct, material.F_cy, reserve)
    left = jnp.sqrt(1.0 - jnp.square(reserve * jnp.concatenate([pulled, pressed], axis=1)))
    shares = jnp.concatenate([shear / material.F_tu, shear / material.F_cy], axis=1)
    return reserve * buckling.von_mises(0.0, 0.0, shares) / left


def cover_buckling_use(model: BoxModel, state: BoxState, t: Float[Array, "4 n"]) -> Float[Array, "2 2 case n"]:
    """Utilisation of the skin panels between stringers and ribs in compression with shear: R_c + R_s^2 = 1.

    The panel is flat, simply supported, stringer pitch wide and rib pitch long, at the stress of the
    extreme fibre; both ends of a cover are looked at.

    Returns:
        Utilisation by cover, end, case, station.
    """
    f_cy, square = model.material.F_cy, jnp.square(t[:2, None, None])
    pressed = f_cy * positive_part(-state.cover_direct[:, None] / f_cy, SMOOTH_WIDTH)
    r_c = pressed / (model.critical.cover_compression * square)
    r_s = state.cover_shear / (model.critical.cover_shear * square)
    return model.concept.reserve * buckling.use_compression_shear(r_c, r_s)


def web_buckling_use(model: BoxModel, state: BoxState, t: Float[Array, "4 n"]) -> Float[Array, "2 case n"]:
    """Utilisation of the webs, unstiffened between ribs, in shear and in-plane bending: R_b^2 + R_s^2 = 1."""
    square = jnp.square(t[2:, None])
    r_b = state.web_direct / (model.critical.web_bending * square)
    r_s = state.web_shear[:, 1] / (model.critical.web_shear * square)
    return model.concept.reserve * buckling.use_bending_shear(r_b, r_s)


def panel_use(
    model: BoxModel, state: BoxState, t: Float[Array, "4 n"]
) -> tuple[Float[Array, "4 a n"], Float[Array, "4 b n"], Float[Array, "4 1 n"]]:
    """Utilisation of every panel by criterion, all cases and places side by side.

    Args:
        model: the box and its loads.
        state: stresses at t.
        t: thickness, m [4, n].

    Returns:
        Required reserve factor over reserve factor in von Mises stress, in buckling, and t_min / t.
    """
    n = t.shape[1]
    # The edge of a web has the bending stress, its middle the largest shear flow.
    web_direct = jnp.stack([state.web_direct, jnp.zeros_like(state.web_direct)], axis=1)
    cover_direct = jnp.broadcast_to(state.cover_direct[:, None], state.cover_shear.shape)
    direct = jnp.concatenate([cover_direct, web_direct]).reshape(4, -1, n)
    shear = jnp.concatenate([state.cover_shear, state.web_shear]).reshape(4, -1, n)
    webs = web_buckling_use(model, state, t)
    skins = cover_buckling_use(model, state, t).reshape(2, -1, n)
    unstable = jnp.concatenate([skins, jnp.concatenate([webs, jnp.zeros_like(webs)], axis=1)])
    return _von_mises_use(direct, shear, model), unstable, (model.concept.t_min / t)[:, None]


def crushing_load(model: BoxModel, state: BoxState, t: Float[Array, "4 n"]) -> Float[Array, "2 case n"]:
    """Load per chord on a rib by Brazier's pressure of either cover, N/m: pressure times rib pitch."""
    shape, members = model.shape, model.members
    smeared = t[:2] + members.n_stringer * members.A_stringer / shape.width
    pressure = buckling.brazier_pressure(state.cover_direct, smeared[:, None], shape.h_mean, modulus=model.material.E)
    return pressure * model.concept.rib_pitch


def rib_thickness(model: BoxModel, state: BoxState, t: Float[Array, "4 n"], sharpness: ScalarLike) -> Float[Array, "n"]:
    """Lightest rib: minimum gauge, crushing as a plate between covers and spars, crushing yield; closed form.

    Plate: reserve N / t = k pi^2 E / (12 (1 - nu^2)) (t / w)^2, so t is a cube root; simply supported, no
    stiffeners. The reserve factor is on the crushing STRESS, as everywhere (the load that crushes grows
    with the square of M).

    Returns:
        Thickness of one rib at n stations, m; above the true maximum by at most 0.7 %.
    """
    concept = model.concept
    load = concept.reserve * crushing_load(model, state, t)
    # Powers of the load: the derivative stays finite where it vanishes at the tip.
    plate = smooth_max(load / model.critical.rib / concept.t_min**3, (0, 1), sharpness / 3.0) ** (1.0 / 3.0)
    yielding = smooth_max(load / model.material.F_cy / concept.t_min, (0, 1), sharpness)
    return concept.t_min * smooth_max(jnp.stack([plate, yielding, jnp.ones_like(plate)]), 0, sharpness)
