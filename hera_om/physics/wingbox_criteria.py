"""Utilisation of skins, webs and ribs by their own criteria: required reserve factor over reserve factor."""

from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from hera_om.physics import buckling
from hera_om.physics.box_contour import COVER_POINTS, WEBS
from hera_om.physics.box_section import Section, ShearFlow, section_properties, shear_flow
from hera_om.physics.box_smooth import positive_part, smooth_below, smooth_max
from hera_om.physics.laminate import shear_use
from hera_om.physics.wingbox_types import BoxModel, Material, strength_across

ScalarLike = Float[Array, ""] | float | int

# Share of the direct allowable that a sheet's own von Mises criterion charges to bending, at most. Above it
# the sheet would be thickened for the sake of caps and stringers; design.md section 4 forbids that: their
# reserve then falls below 1.5 and says so. 0.9 leaves a shear stress of 0.25 allowable. Design choice.
DIRECT_SHARE = 0.9
# Fasteners in a row across the load: seldom closer than four diameters nor wider than eight (NAVEDTRA 14018,
# Aviation Structural Mechanic, ch. 13, seen); the middle. Sheets, caps and stringers are crossed by such rows at ribs.
HOLE_PITCH = 6.0
# On the net section between holes nine tenths of F_tu: practice for structure with fasteners, Boeing course V4011.6,
# "Detail Design and Analysis", 4.2.4, as a stress engineer quotes it (eng-tips thread 178465, seen; course not seen).
NOTCH = 0.9
# Width of the smooth positive part and minimum, as a share of the allowable: 2.5e-7 of the allowable off
# where the stress is the allowable, 5e-4 where it is zero.
SMOOTH_WIDTH = 1e-3


# Points of a web between its ends, thirds of it; weights of start, middle, end for the parabola of the flow.
_THIRDS = np.array([[1.0, 0.0, 0.0], [2.0 / 9.0, 8.0 / 9.0, -1.0 / 9.0], [-1.0 / 9.0, 8.0 / 9.0, 2.0 / 9.0], [0, 0, 1]])
_ALONG = np.linspace(0.0, 1.0, 4)[:, None]


class BoxState(NamedTuple):
    """Stresses at four points of each panel, tension positive, Pa, with the section they come from."""

    section: Section
    flow: ShearFlow
    direct: Float[Array, "4 point case n"]
    shear: Float[Array, "4 point case n"]


def _panel_points(nodes: Float[Array, "k n"]) -> Float[Array, "4 4 n"]:
    """Values at the points of the panels of what is linear along each segment."""
    after = jnp.roll(nodes, -1, axis=0)
    webs = [nodes[i] + _ALONG * (after[i] - nodes[i]) for i in WEBS]
    return jnp.concatenate([nodes[COVER_POINTS], jnp.stack(webs)])


def _panel_flows(flow: ShearFlow) -> Float[Array, "2 4 4 n"]:
    """Flow per unit force at the points of the panels."""
    covers = [jnp.concatenate([flow.start[:, p[:-1]], flow.end[:, p[-1:] - 1]], axis=1) for p in COVER_POINTS]
    parabola = [jnp.stack([flow.start[:, i], flow.middle[:, i], flow.end[:, i]], axis=1) for i in WEBS]
    return jnp.stack([*covers, *(jnp.einsum("ps,fsn->fpn", _THIRDS, v) for v in parabola)], axis=1)


def box_state(model: BoxModel, t: Float[Array, "4 n"]) -> BoxState:
    """Stresses of the box at thickness t: engineer's bending in two axes, shear flow, Bredt's torsion.

    sigma = b x + c z with [I_zz I_xz; I_xz I_xx] [b, c] = [Mz, -M] (Megson, eq. 16.18); q = H q_aft + V q_up
    + T_sc / (2 A), with the torque moved to the shear centre, T_sc = T + V (x_sc - x_axis) - H z_sc.

    Args:
        model: shape, members, loads.
        t: thickness of upper skin, lower skin, front web, rear web, m [4, n].

    Returns:
        Stresses for every load case.
    """
    shape, loads = model.shape, model.loads
    section = section_properties(shape, model.members, t)
    flow = shear_flow(shape, section, t)
    x, z = _panel_points(shape.x - section.x_centroid), _panel_points(shape.z - section.z_centroid)
    whole = section.I_xx * section.I_zz - jnp.square(section.I_xz)
    by_x = (section.I_xx * loads.Mz + section.I_xz * loads.M) / whole
    by_z = -(section.I_zz * loads.M + section.I_xz * loads.Mz) / whole
    torque = loads.T + loads.V * (flow.x_shear_centre - model.x_axis) - loads.H * flow.z_shear_centre
    aft, up = _panel_flows(flow)
    q = aft[:, :, None] * loads.H + up[:, :, None] * loads.V + torque / (2.0 * shape.enclosed)
    return BoxState(section, flow, x[:, :, None] * by_x + z[:, :, None] * by_z, q / t[:, None, None])


def _direct_share(stress: Float[Array, "..."], allowable: ScalarLike, reserve: ScalarLike) -> Float[Array, "..."]:
    """Positive direct stress over its allowable, at most ``DIRECT_SHARE`` of 1 / reserve."""
    share = positive_part(stress / allowable, SMOOTH_WIDTH)
    return smooth_below(share, DIRECT_SHARE / reserve, SMOOTH_WIDTH)


def tension_allowable(material: Material) -> ScalarLike:
    """Ultimate tension on the gross section of what is drilled, Pa: NOTCH (1 - 1 / HOLE_PITCH) F_tu. Static."""
    return NOTCH * (1.0 - 1.0 / HOLE_PITCH) * jnp.asarray(material.F_tu)


def strength_use(state: BoxState, model: BoxModel) -> Float[Array, "4 _ case n"]:
    """Utilisation in strength, on the net section in tension and against F_cy in compression, along axis 1.

    By von Mises, or of every ply by Tsai and Wu, whose direct stress is that of the net section too.

    s^2 + 3 tau^2 = (F / RF)^2 is asked as sqrt(3) tau over the sqrt((F / RF)^2 - s^2) left to it, and Tsai and Wu
    alike: one at the same thickness, but never flat where bending takes most of the allowable, which Newton's
    method would not stand. What a direct stress adds to the shear strength of a ply is not counted.
    """
    material, reserve = model.material, model.concept.reserve
    torn = tension_allowable(material)
    pulled = _direct_share(state.direct, torn, reserve)
    pressed = _direct_share(-state.direct, material.F_cy, reserve)
    if material.laminate is not None:
        direct = jnp.concatenate([material.F_tu * pulled, -material.F_cy * pressed], axis=1)
        plies = shear_use(material.laminate, reserve * direct, reserve * jnp.concatenate([state.shear] * 2, axis=1))
        return jnp.concatenate(list(plies), axis=1)
    left = jnp.sqrt(1.0 - jnp.square(reserve * jnp.concatenate([pulled, pressed], axis=1)))
    shares = jnp.concatenate([state.shear / torn, state.shear / material.F_cy], axis=1)
    return reserve * buckling.von_mises(0.0, 0.0, shares) / left


def cover_buckling_use(model: BoxModel, state: BoxState, t: Float[Array, "4 n"]) -> Float[Array, "2 point case n"]:
    """Utilisation of the skin panels between stringers and ribs in compression with shear: R_c + R_s^2 = 1.

    The panel is flat, simply supported, stringer pitch wide and rib pitch long, at the stress of each point of
    the cover. It does not buckle below the required reserve, so the whole sheet stays effective.

    Returns:
        Utilisation by cover, point, case, station.
    """
    f_cy, square = model.material.F_cy, jnp.square(t[:2, None, None])
    pressed = f_cy * positive_part(-state.direct[:2] / f_cy, SMOOTH_WIDTH)
    r_c = pressed / (model.critical.cover_compression * square)
    r_s = state.shear[:2] / (model.critical.cover_shear * square)
    return model.concept.reserve * buckling.use_compression_shear(r_c, r_s)


def web_buckling_use(model: BoxModel, state: BoxState, t: Float[Array, "4 n"]) -> Float[Array, "2 point case n"]:
    """Utilisation of the webs, unstiffened between ribs, in shear and in-plane bending: R_b^2 + R_s^2 = 1.

    The bending stress is that of either edge, of either sign: what of it is not bending is small, and compression
    of the whole web would be the tip's bending aft.
    """
    square = jnp.square(t[2:, None, None])
    edges = jnp.concatenate([state.direct[2:, :1], state.direct[2:, -1:]], axis=1)
    r_b = edges / (model.critical.web_bending[:, None] * square)
    r_s = state.shear[2:, 1:3] / (model.critical.web_shear[:, None] * square)
    return model.concept.reserve * buckling.use_bending_shear(r_b, r_s)


def cover_crushing_use(model: BoxModel, state: BoxState, t: Float[Array, "4 n"]) -> Float[Array, "2 point case n"]:
    """Utilisation of the skins by Brazier's pressure between the stringers: chordwise bending against yield.

    A long strip clamped at two stringers, s_b = p b^2 / (2 t^2) (Timoshenko & Woinowsky-Krieger, Theory of Plates
    and Shells, art. 1-3). p grows with the square of the load, so the factor on the load is sqrt(F / s_b).
    """
    pressure = crushing_pressure(model, state, t)
    bending = 0.5 * pressure * jnp.square(model.concept.stringer_pitch / t[:2, None, None])
    return model.concept.reserve * jnp.sqrt(bending / strength_across(model.material) + 1e-12)


def panel_use(model: BoxModel, state: BoxState, t: Float[Array, "4 n"]) -> tuple[Float[Array, "4 _ _ n"], ...]:
    """Utilisation of every panel by criterion, place and case.

    Args:
        model: the box and its loads.
        state: stresses at t.
        t: thickness, m [4, n].

    Returns:
        Required reserve factor over reserve factor by each of ``CRITERIA``; gauge has one place and no case.
    """
    webs = jnp.concatenate([web_buckling_use(model, state, t)] * 2, axis=1)
    unstable = jnp.concatenate([cover_buckling_use(model, state, t), webs.at[:, 2:].set(0.0)])
    crushed = cover_crushing_use(model, state, t)
    gauge = (model.concept.t_min / t)[:, None, None]
    return strength_use(state, model), unstable, jnp.concatenate([crushed, 0.0 * crushed]), gauge


def crushing_pressure(model: BoxModel, state: BoxState, t: Float[Array, "4 n"]) -> Float[Array, "2 point case n"]:
    """Brazier's pressure of either cover at LIMIT load, Pa."""
    members = model.members
    smeared = t[:2] + members.n_stringer * members.A_stringer / model.shape.arc
    height = model.shape.h_mean
    return buckling.brazier_pressure(state.direct[:2], smeared[:, None, None], height, modulus=model.material.E)


def rib_thickness(model: BoxModel, state: BoxState, t: Float[Array, "4 n"], sharpness: ScalarLike) -> Float[Array, "n"]:
    """Lightest rib: minimum gauge, crushing as a plate between covers and spars, crushing yield; closed form.

    N = pressure times rib pitch. Plate: r^2 N / t = k pi^2 E / (12 (1 - nu^2)) (t / w)^2, so t is a cube root;
    simply supported, no stiffeners. The reserve r is on the load that bends the wing; what crushes grows with
    its square.

    Returns:
        Thickness of one rib at n stations, m; above the true maximum by at most 0.7 %.
    """
    concept = model.concept
    load = jnp.square(concept.reserve) * crushing_pressure(model, state, t) * concept.rib_pitch
    # Powers of the load: the derivative stays finite where it vanishes at the tip.
    plate = smooth_max(load / model.critical.rib / concept.t_min**3, (0, 1, 2), sharpness / 3.0) ** (1.0 / 3.0)
    yielding = smooth_max(load / model.material.F_cy / concept.t_min, (0, 1, 2), sharpness)
    return concept.t_min * smooth_max(jnp.stack([plate, yielding, jnp.ones_like(plate)]), 0, sharpness)
