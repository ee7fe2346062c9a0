"""Wing mass beyond the sized box: what joins, opens and stiffens it, and secondary structure by area.

Torenbeek, Advanced Aircraft Design (Wiley 2013), ch. 11: the ideal box, weight penalties of what an ideal box leaves
out, secondary structure by specific weights. The book was not at hand: every coefficient is as open programs
transcribe it; how many of them agree stands beside it, and in docs/theory/wing_mass.md.
"""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from hera_om.physics.beam_loads import STANDARD_GRAVITY

ScalarLike = Float[Array, ""] | float | int

# Penalties of the box, section 11.4. In brackets: programs that agree, tests/reference/wing_build_up_readings.csv.
JOINTS = 1.0e-3  # m: smeared over skins and webs for steps in thickness, joints, fasteners, doublers (1)
FAIL_SAFETY = 0.18 / 1.2  # of the shear material: 0.18 n W eta b rho g / sigma against 1.2 of the ideal (2)
MANHOLE = 0.25  # m: width of the holes in a cover, R = 1 + 2 w b / S on the panels that hold them (2)
ENGINES, PER_ENGINE = 0.015, 0.2  # 0.015 (1 + 0.2 N) of the power plants (2)
GEAR = 0.0015  # of landing weight times ultimate factor, where the main gear hangs on the wing (1)
FUSELAGE = 0.0003  # of take-off weight times ultimate factor (2)
STIFFNESS = 200.0  # N: torsional stiffness against reversal and flutter (1; the form without the number in another)
# Specific weights, section 11.5, eq. 11.63 to 11.66.
OMEGA = 56.0  # N/m2, reference (4)
W_REF, B_REF, Q_REF, S_REF = 1.0e6, 50.0, 3.0e4, 10.0  # N, m, Pa, m2 (4)
LEADING, LEADING_Q, LEADING_WB = 3.15, 0.25, 0.145  # fixed leading edge without slats (4)
TRAILING, TRAILING_WB = 2.6, 0.0544  # fixed trailing edge (4)
FOWLER = {1: 40.0, 2: 100.0}  # N/m2 more above flaps that travel, by slots (2; a third reads 40 for both)
FLAP, FLAP_W = 1.7, 0.35  # (3)
SLOTS = {1: 1.0, 2: 1.5}  # (2; a third reads 1 for both)
# Three programs read 1.0, 1.2 and 1.6, the last for Fowler flaps; which kind the others mean they do not say: the
# names of the first two are ours.
SUPPORTS = {"hinge": 1.0, "link": 1.2, "track": 1.6}
AILERON, AILERON_S = 3.0, 0.044  # (4)
AILERON_BALANCE = 1.3  # by an aerodynamic nose (3); 1.0 without balance, 1.54 with masses
TIPS, TIPS_W = 150.0, 0.67  # N (1; another reads the exponent 0.65)
MISCELLANEOUS = 0.10  # paint, fairings, seals: of the secondary structure (2)


class WingFacts(NamedTuple):
    """What the build-up needs beside the box; masses in kg, ``span`` along the structure, m."""

    take_off: ScalarLike
    landing: ScalarLike
    power_plants: ScalarLike
    """On both sides of the wing."""
    engines: ScalarLike
    span: ScalarLike
    area: ScalarLike
    """Of the whole planform, m2."""
    ultimate_factor: ScalarLike
    gear_factor: ScalarLike
    """Ultimate load factor of the ground; zero where the gear is not on the wing."""
    q_D: ScalarLike
    """Dynamic pressure at the design diving speed, Pa."""
    mach_D: ScalarLike
    thickness: ScalarLike
    """Thickness ratio just inboard of the ailerons."""
    cos_leading: ScalarLike
    sin_half: ScalarLike
    """Sweep of the leading edge and of the half-chord line."""


class SecondaryAreas(NamedTuple):
    """Projected areas of both sides, m2; none is counted twice."""

    leading: ScalarLike
    trailing: ScalarLike
    """Fixed, behind the rear spar."""
    above_flaps: ScalarLike
    """The part of ``trailing`` along the flaps."""
    flaps: ScalarLike
    ailerons: ScalarLike


class Flaps(NamedTuple):
    """What kind of flaps."""

    slots: int = 1
    support: str = "hinge"


class BoxShares(NamedTuple):
    """Of the sized box, both sides and the centre section."""

    surface: Float[Array, ""]
    """Of skins and webs, m2."""
    webs: Float[Array, ""]
    lower_panels: Float[Array, ""]
    """Lower skin and stringers, kg."""


class Penalties(NamedTuple):
    """Mass that an ideal box lacks, kg."""

    joints: Float[Array, ""]
    fail_safety: Float[Array, ""]
    manholes: Float[Array, ""]
    engines: Float[Array, ""]
    gear: Float[Array, ""]
    fuselage: Float[Array, ""]
    stiffness: Float[Array, ""]


class Secondary(NamedTuple):
    """Mass of the secondary structure, kg."""

    leading_edge: Float[Array, ""]
    trailing_edge: Float[Array, ""]
    flaps: Float[Array, ""]
    ailerons: Float[Array, ""]
    tips: Float[Array, ""]
    miscellaneous: Float[Array, ""]


def chord_integral(
    y: Float[Array, "k"], chord: Float[Array, "k"], inner: ScalarLike, outer: ScalarLike
) -> Float[Array, ""]:
    """Area of one side between two stations of a wing with straight edges between its sections, m2."""
    low, high = (jnp.clip(jnp.asarray(v, float), y[:-1], y[1:]) for v in (inner, outer))
    middle = (0.5 * (low + high) - y[:-1]) / jnp.diff(y)
    return jnp.sum((high - low) * (chord[:-1] + jnp.diff(chord) * middle))


def box_penalties(facts: WingFacts, box: BoxShares, density: ScalarLike) -> Penalties:
    """Penalties on the sized box for what its criteria do not see.

    Joints: rho delta S_box; fail safety: a share of the webs; manholes: 2 w b / S of the lower panels; power plants
    0.015 (1 + 0.2 N) m; gear 0.0015 n m; fuselage 0.0003 n m; stiffness
    W_ref (q_D / q_ref) (b cos L_0 / b_ref)^3 (t/c)^-2 (1 - sin L_50) / sqrt(1 - (M_D cos L_50)^2) / g.
    Torenbeek 2013, section 11.4; see the constants.

    Args:
        facts: the aircraft and its wing.
        box: what is penalised.
        density: of the box's material, kg/m3.

    Returns:
        Masses, kg. Valid for metal wings of transports with a diving Mach number below one; N above four
        extrapolates.
    """
    cos_square = 1.0 - jnp.square(facts.sin_half)
    compressible = jnp.sqrt(1.0 - jnp.square(facts.mach_D) * cos_square)
    reach = facts.span * facts.cos_leading / B_REF
    turning = reach**3 / jnp.square(facts.thickness) * (1.0 - facts.sin_half) / compressible
    return Penalties(
        joints=JOINTS * density * box.surface,
        fail_safety=FAIL_SAFETY * box.webs,
        manholes=2.0 * MANHOLE * facts.span / facts.area * box.lower_panels,
        engines=jnp.asarray(ENGINES * (1.0 + PER_ENGINE * facts.engines) * facts.power_plants),
        gear=jnp.asarray(GEAR * facts.gear_factor * facts.landing),
        fuselage=jnp.asarray(FUSELAGE * facts.ultimate_factor * facts.take_off),
        stiffness=STIFFNESS * facts.q_D / Q_REF * turning / STANDARD_GRAVITY,
    )


def secondary_structure(facts: WingFacts, areas: SecondaryAreas, flaps: Flaps) -> Secondary:
    """Secondary structure by area, loading and kind.

    Specific weights, N/m2, with W b / (W_ref b_ref) the size of the wing: leading edge 3.15 Omega (q_D / q_ref)^0.25
    size^0.145; trailing edge 2.6 Omega size^0.0544, more above flaps that travel; flaps 1.7 k_sup k_slot Omega
    (1 + (W / W_ref)^0.35); ailerons 3 k_bal Omega (S / S_ref)^0.044; tips 150 N (W / W_ref)^0.67; a tenth of all
    these for the rest. Torenbeek 2013, eq. 11.63 to 11.66 and section 11.5.

    Args:
        facts: the aircraft and its wing.
        areas: projected areas.
        flaps: their kind.

    Returns:
        Masses, kg. Aluminium; without slats and spoilers.
    """
    weight = STANDARD_GRAVITY * jnp.asarray(facts.take_off)
    size, unit = weight * facts.span / (W_REF * B_REF), OMEGA / STANDARD_GRAVITY
    travelling = FOWLER[flaps.slots] / STANDARD_GRAVITY if flaps.support != "hinge" else 0.0
    moved = FLAP * SUPPORTS[flaps.support] * SLOTS[flaps.slots]
    # A wing without ailerons has none to weigh: the power of their area must not meet zero.
    share = jnp.maximum(jnp.asarray(areas.ailerons, float), 1e-9) / S_REF
    found = (
        LEADING * unit * (facts.q_D / Q_REF) ** LEADING_Q * size**LEADING_WB * areas.leading,
        TRAILING * unit * size**TRAILING_WB * areas.trailing + travelling * areas.above_flaps,
        moved * unit * (1.0 + (weight / W_REF) ** FLAP_W) * areas.flaps,
        AILERON * AILERON_BALANCE * unit * share**AILERON_S * areas.ailerons,
        TIPS / STANDARD_GRAVITY * (weight / W_REF) ** TIPS_W,
    )
    edge, rear, movable, aileron, tips = (jnp.asarray(part) for part in found)
    return Secondary(edge, rear, movable, aileron, tips, MISCELLANEOUS * (edge + rear + movable + aileron + tips))


def total(parts: Penalties | Secondary) -> Float[Array, ""]:
    """Sum of all parts, kg."""
    return jnp.sum(jnp.stack([jnp.asarray(p) for p in parts]))
