"""Reserve factors of what is given: caps and stringers in tension and compression."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from hera_om.physics import box_section, buckling
from hera_om.physics.box_section import z_stringer
from hera_om.physics.box_smooth import positive_part, smooth_below, smooth_max
from hera_om.physics.wingbox_criteria import BoxState, tension_allowable
from hera_om.physics.wingbox_types import BoxModel, Material, Reserves

ScalarLike = Float[Array, ""] | float | int

# End fixity of a stringer over its ribs: effective length = rib pitch / sqrt(c). 1 is pinned, the lower
# bound; Bruhn C7 and Niu allow 1.5 to 2 for ribs riveted to the stringers.
COLUMN_FIXITY = 1.0
SMOOTH_WIDTH = 1e-3


def column_stress(model: BoxModel, t_skin: Float[Array, "2 n"]) -> Float[Array, "2 n"]:
    """Failing stress of a stringer with its effective skin between two ribs.

    Johnson-Euler from the crippling stress; the skin works over 1.9 t sqrt(E / F_cc), at most one pitch,
    which is never buckled at the required reserve since it is sized so. Bruhn C7.26, C7.19.

    Args:
        model: box, material, concept.
        t_skin: upper and lower skin, m [2, n].

    Returns:
        Stress, Pa, for upper and lower stringers.
    """
    concept, material, members = model.concept, model.material, model.members
    z = z_stringer(members.A_stringer)
    f_cc = buckling.crippling_stress(z.area_over_t2, modulus=material.E, f_cy=material.F_cy)
    pitch = concept.stringer_pitch
    width = pitch * smooth_below(buckling.effective_width(t_skin, f_cc, modulus=material.E) / pitch, 1.0, 0.01)
    skin = width * t_skin
    area = members.A_stringer + skin
    arm = z.centroid + 0.5 * t_skin
    inertia = (
        members.A_stringer * (z.gyration_square + jnp.square(arm) * skin / area) + skin * jnp.square(t_skin) / 12.0
    )
    length_square = jnp.square(concept.rib_pitch) / COLUMN_FIXITY
    return buckling.johnson_euler_stress(jnp.sqrt(length_square * area / inertia), f_cc, modulus=material.E)


def cap_stress(material: Material) -> Float[Array, ""]:
    """Failing stress of a cap in compression, Pa: yield or Needham's crippling.

    The flange, `box_section.CAP_ASPECT` times as wide as thick, as one of two legs of an angle with free edges:
    the least favourable reading of a flange that the web in truth holds.
    """
    return buckling.angle_crippling_stress(box_section.CAP_ASPECT, modulus=material.E, f_cy=material.F_cy)


def cover_compression(model: BoxModel, state: BoxState, t: Float[Array, "4 n"]) -> Float[Array, "2 2 point case n"]:
    """Compressive stress over its allowable, of caps and of stringers (first axis) on either cover."""
    pressed = positive_part(-state.direct[:2] / model.material.F_cy, SMOOTH_WIDTH)
    short = cap_stress(model.material) / model.material.F_cy
    column = column_stress(model, t[:2])[:, None, None] / model.material.F_cy
    return jnp.stack([pressed / short, pressed / column])


def reserves(model: BoxModel, state: BoxState, t: Float[Array, "4 n"], sharpness: ScalarLike) -> Reserves:
    """RFT and RFC of caps and stringers: allowable over LIMIT stress, required 1.5.

    Tension against F_tu on the net section between fastener holes (`wingbox_criteria.tension_allowable`).
    Compression: caps against the smaller of F_cy and their crippling stress, stringers against the smaller of that
    and the column stress (which starts from crippling). Both carry the stress of the skin that they are fastened to.

    Args:
        model: the box and its loads.
        state: stresses at t.
        t: thickness, m [4, n].
        sharpness: exponent of the smooth extremes.

    Returns:
        Reserve factors over the span and their smooth minima: below the true minimum by at most (8 case
        n)^(1/sharpness).
    """
    material = model.material
    torn = tension_allowable(material)
    pulled = positive_part(state.direct[:2] / torn, SMOOTH_WIDTH)
    pressed = positive_part(-state.direct[:2] / material.F_cy, SMOOTH_WIDTH)
    use_tension = smooth_max(pulled, (0, 1, 2), sharpness)
    use_compression = smooth_max(cover_compression(model, state, t), (0, 1, 2, 3), sharpness)
    yielding = jnp.stack([pulled * torn / material.F_ty, pressed])
    return Reserves(
        1.0 / use_tension,
        1.0 / use_compression,
        1.0 / smooth_max(use_tension, 0, sharpness),
        1.0 / smooth_max(use_compression, 0, sharpness),
        1.0 / smooth_max(yielding, (0, 1, 2, 3, 4), sharpness),
    )
