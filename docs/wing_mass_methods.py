"""Published wing mass methods as open programs write them, for comparison: SI in and out, masses in kg."""

from dataclasses import dataclass, replace

POUND, FOOT, GRAVITY = 0.45359237, 0.3048, 9.80665


@dataclass(frozen=True)
class Wing:
    """What the methods ask of a straight wing with the engines on it and the gear off it."""

    mass: float
    zero_fuel: float
    """Without the wing: what is hung on it, kg."""
    span: float
    area: float
    thickness: float
    root_chord: float
    taper: float
    ultimate: float
    V_D: float
    control_area: float
    engines: int = 2


def torenbeek(w: Wing) -> float:
    """Synthesis of Subsonic Airplane Design, eq. 8-12: AeroSandbox, torenbeek_weights.mass_wing_simple."""
    slender = w.span / (w.thickness * w.root_chord) / (w.zero_fuel / w.area)
    return 6.67e-3 * w.zero_fuel * w.span**0.75 * (1 + (1.905 / w.span) ** 0.5) * w.ultimate**0.55 * slender**0.30


def torenbeek_basic(w: Wing) -> float:
    """The same, appendix C, eq. C-1 to C-5, without movables: AeroSandbox, mass_wing_basic_structure."""
    load = w.ultimate * (0.8 * w.zero_fuel + 0.2 * w.mass)
    factors = joints_1976(w.span) * (1 + w.taper) ** 0.4 * 0.95 * 0.95 * stiffness_1976(w)
    return 4.58e-3 * factors * load**0.55 * w.span**1.675 * w.thickness**-0.45


def joints_1976(span: float) -> float:
    """Eq. C-2: joints, skin without taper, least gauge."""
    return 1 + (1.905 / span) ** 0.5


def stiffness_1976(w: Wing) -> float:
    """Eq. C-4: stiffness against flutter."""
    return 1 + 9.06e-4 * w.span**3 / w.mass * (w.V_D / 100 / w.thickness) ** 2


def raymer(w: Wing) -> float:
    """Aircraft Design, eq. 15.25, transports: AeroSandbox, raymer_cargo_transport_weights.mass_wing."""
    pounds = 0.0051 * (w.mass / POUND * w.ultimate) ** 0.557 * (w.area / FOOT**2) ** 0.649
    shape = (w.span**2 / w.area) ** 0.5 * w.thickness**-0.4 * (1 + w.taper) ** 0.1
    return pounds * shape * (w.control_area / FOOT**2) ** 0.1 * POUND


def flops(w: Wing) -> float:
    """FLOPS, simple bending factor: Aviary, flops_based/wing_simple and wing_common; no sweep, no composites."""
    b, s, gross = w.span / FOOT, w.area / FOOT**2, w.mass / POUND
    aspect = b**2 / s
    tangent = -2 * (1 - w.taper) / (aspect * (1 + w.taper))
    sine = tangent / (1 + tangent**2) ** 0.5
    shape = (1 - sine**2) * (1 + 0.03 * max(aspect - 5, 0) * sine)
    bending = 0.215 * (0.37 + 0.7 * w.taper) * aspect / (shape * w.thickness)
    ideal = 8.80 * bending * (1 + (6.25 / b) ** 0.5) * w.ultimate * b * 1e-6
    rest = 0.68 * (w.control_area / FOOT**2) ** 0.34 * gross**0.6 + 0.035 * s**1.5
    return (gross * (1 - 0.03 * w.engines) * ideal + rest) / (1 + ideal) * POUND


def fast_oad_rta(w: Wing) -> float:
    """FAST-OAD-RTA, a1_wing_weight: bending, shear, ribs, secondary parts; sizing load n m / 1.5 of the limit."""
    load, outer = w.mass * w.ultimate / 1.5, 0.86 * w.area
    bending = 5.922e-5 * (load / (w.root_chord * w.thickness) * w.span**2) ** 0.9
    shear = 5.184e-4 * (load * w.span) ** 0.9
    return bending + shear + 1.7009 * w.area + 1e-3 * load + secondary_rta(w.mass, outer)


def secondary_rta(mass: float, outer_area: float) -> float:
    """Secondary parts of FAST-OAD-RTA, A15, with its k_mvo of 1.39."""
    return 0.3285 * 1.39 * mass**0.35 * outer_area


def secondary_1992(mass: float, leading: float, trailing: float, flaps: float, ailerons: float) -> float:
    """LR-693 (1992) as one program writes it: leading and trailing edge, flaps of one slot, ailerons."""
    weight = 1e-6 * GRAVITY * mass
    newtons = 75 * (1 + weight**0.5) * leading + 60 * (1 + 1.6 * weight**0.5) * trailing
    newtons += 100 * (1 + weight**0.5) * flaps + 125 * (1 + 0.5 * weight**0.25) * ailerons
    return newtons / GRAVITY


TASOPT = 0.20 + 0.04 + 0.10 + 0.02 + 0.03
"""Flaps, ailerons, edges, spoilers, attachments over the box: TASOPT.jl, default_regional.toml; ribs and slats out."""

METHODS = {
    "Torenbeek 8-12": torenbeek,
    "Torenbeek C-1, basic": torenbeek_basic,
    "Raymer 15.25": raymer,
    "FLOPS": flops,
    "FAST-OAD-RTA": fast_oad_rta,
}


def varied(wing: Wing, what: str, factor: float) -> Wing:
    """The wing with one thing changed; the span at the same area and thickness ratio."""
    if what == "span":
        return replace(wing, span=wing.span * factor, root_chord=wing.root_chord / factor)
    field = {"ultimate factor": "ultimate", "thickness": "thickness"}[what]
    return replace(wing, **{field: getattr(wing, field) * factor})
