"""The registry of shared variables: one name, one unit, one meaning, wherever a variable appears.

Names that carry a rotor group (``theta_electric``) and derivatives (``Cm_q``, ``CX_theta_hybrid``) are
resolved by ``quantity`` and not listed. Units are OpenMDAO's; None is dimensionless.
"""

import difflib
import re
from dataclasses import dataclass, replace


@dataclass(frozen=True)
class Quantity:
    """A shared variable. ``default`` is None for an output."""

    name: str
    units: str | None
    desc: str
    default: float | None = None


def _table(*rows: Quantity) -> dict[str, Quantity]:
    """Quantities by name."""
    return {row.name: row for row in rows}


INPUTS = _table(
    Quantity("alpha", "deg", "angle of attack of the fuselage axis", 0.0),
    Quantity("beta", "deg", "sideslip, wind from starboard positive", 0.0),
    Quantity("mach", None, "Mach number", 0.0),
    Quantity("altitude", "m", "geopotential altitude in the standard atmosphere", 0.0),
    Quantity("p_hat", None, "roll rate p b / 2V", 0.0),
    Quantity("q_hat", None, "pitch rate q c / 2V", 0.0),
    Quantity("r_hat", None, "yaw rate r b / 2V", 0.0),
    Quantity("delta_e", "deg", "elevator, trailing edge down positive", 0.0),
    Quantity("delta_a", "deg", "aileron, right trailing edge down positive", 0.0),
    Quantity("delta_r", "deg", "rudder, trailing edge to port positive", 0.0),
    Quantity("delta_f", "deg", "flap, trailing edge down positive", 0.0),
    Quantity("y_kink", "m", "spanwise place of the wing's kink", 0.0),
    Quantity("theta_tip", "deg", "twist of the wing's tip", 0.0),
    Quantity("y_prop", "m", "spanwise place of the inner electric rotor", 0.0),
    Quantity("htail_scale", None, "linear scale of the horizontal tail", 1.0),
    Quantity("A_cap_root", "m**2", "area of one spar cap at the root", 0.0),
    Quantity("A_stringer_root", "m**2", "area of one stringer at the root", 0.0),
)

OUTPUTS = _table(
    Quantity("CL", None, "lift coefficient, wind axes, without hub loads"),
    Quantity("CD", None, "drag coefficient, wind axes, without hub loads"),
    Quantity("CDi", None, "induced drag coefficient, far field"),
    Quantity("CDi_near", None, "induced drag coefficient, near field"),
    Quantity("CD_profile", None, "profile drag coefficient of the strips"),
    Quantity("CD_fuselage", None, "drag coefficient of the fuselage"),
    Quantity("CD_areas", None, "drag coefficient of the drag areas"),
    Quantity("CD_slipstream", None, "change of the drag coefficient by the slipstreams"),
    Quantity("CX", None, "force coefficient along x, aft"),
    Quantity("CY", None, "force coefficient along y, starboard"),
    Quantity("CZ", None, "force coefficient along z, up"),
    Quantity("Cl", None, "rolling moment coefficient by b, right wing down positive"),
    Quantity("Cm", None, "pitching moment coefficient by c, nose up positive"),
    Quantity("Cn", None, "yawing moment coefficient by b, nose right positive"),
    Quantity("CT", None, "thrust coefficient T / (rho n^2 D^4)"),
    Quantity("CP", None, "power coefficient P / (rho n^3 D^5)"),
    Quantity("thrust", "N", "thrust of all rotors along their axes"),
    Quantity("power", "W", "shaft power of all rotors"),
    Quantity("L_over_D", None, "lift over drag, without hub loads"),
    Quantity("cl_span", None, "section lift coefficient by strip"),
    Quantity("x_np", "m", "neutral point"),
    Quantity("static_margin", None, "static margin -Cm_alpha / CZ_alpha at the centre of gravity"),
    Quantity("omega_sp", "rad/s", "short period, undamped frequency"),
    Quantity("zeta_sp", None, "short period, damping ratio"),
    Quantity("omega_ph", "rad/s", "phugoid, undamped frequency"),
    Quantity("zeta_ph", None, "phugoid, damping ratio"),
    Quantity("omega_dr", "rad/s", "dutch roll, undamped frequency"),
    Quantity("zeta_dr", None, "dutch roll, damping ratio"),
    Quantity("tau_roll", "s", "roll subsidence, time constant"),
    Quantity("t2_spiral", "s", "spiral, time to double amplitude"),
    Quantity("CAP", "1/s**2", "control anticipation parameter omega_sp^2 / (n/alpha), per g"),
    Quantity("RFC", None, "least reserve factor of caps and stringers in compression"),
    Quantity("RFT", None, "least reserve factor of caps and stringers in tension"),
    Quantity("m_wing", "kg", "mass of the wing"),
    Quantity("mass", "kg", "mass of the aircraft"),
    Quantity("x_cg", "m", "centre of gravity, x"),
    Quantity("y_cg", "m", "centre of gravity, y"),
    Quantity("z_cg", "m", "centre of gravity, z"),
    Quantity("Ixx", "kg*m**2", "moment of inertia about the body's x axis at the centre of gravity"),
    Quantity("Iyy", "kg*m**2", "moment of inertia about the body's y axis at the centre of gravity"),
    Quantity("Izz", "kg*m**2", "moment of inertia about the body's z axis at the centre of gravity"),
    Quantity("Ixz", "kg*m**2", "product of inertia, sum of m dx dz in geometry axes, at the centre of gravity"),
    Quantity("range_fixed_mass", "km", "range at fixed take-off mass: mass saved becomes fuel"),
    Quantity("range_fixed_fuel", "km", "range at fixed fuel"),
    Quantity("range_per_energy", "m/J", "range per shaft energy"),
)

REGISTRY: dict[str, Quantity] = INPUTS | OUTPUTS

_FAMILIES = {  # prefix of a name by rotor group; the text is completed with the group's name
    "theta_": Quantity("", "deg", "blade pitch at 75 % of the radius, rotor group", 0.0),
    "thrust_": Quantity("", "N", "thrust of one rotor of group"),
    "power_": Quantity("", "W", "shaft power of one rotor of group"),
    "CT_": Quantity("", None, "thrust coefficient T / (rho n^2 D^4) of one rotor of group"),
    "CP_": Quantity("", None, "power coefficient P / (rho n^3 D^5) of one rotor of group"),
    "eta_": Quantity("", None, "propulsive efficiency of one rotor of group"),
}
_COEFFICIENTS = "CL CD CX CY CZ Cl Cm Cn".split()
_RATES = {
    "p": "the roll rate p b / 2V",
    "q": "the pitch rate q c / 2V",
    "r": "the yaw rate r b / 2V",
    "alphadot": "the rate alphadot c / 2V",
    "betadot": "the rate betadot b / 2V",
    "mach": "the Mach number",
}
_ANGLE = re.compile(r"alpha|beta|delta_[aerf]|theta_[A-Za-z][A-Za-z0-9_]*")
_GROUP = re.compile(r"[A-Za-z][A-Za-z0-9_]*")


def quantity(name: str) -> Quantity:
    """The shared variable of a name; rotor families and derivatives included.

    A derivative by an angle is per radian although the angle itself is in degrees; one by a rate is per unit
    of the dimensionless rate.

    Raises:
        KeyError: no such name; the message gives the nearest ones.
    """
    found = REGISTRY.get(name) or _derivative(name) or _family(name)
    if found is None:
        near = difflib.get_close_matches(name, [*REGISTRY, *_examples()], n=3, cutoff=0.6)
        hint = f"; did you mean {' or '.join(near)}?" if near else ""
        raise KeyError(f"{name!r} is no shared variable{hint}")
    return found


def _derivative(name: str) -> Quantity | None:
    """A derivative of a force or moment coefficient."""
    coefficient, _, by = name.partition("_")
    if coefficient not in _COEFFICIENTS:
        return None
    if _ANGLE.fullmatch(by):
        return Quantity(name, "1/rad", f"derivative of {coefficient} by {by}, per radian")
    if by in _RATES:
        return Quantity(name, None, f"derivative of {coefficient} by {_RATES[by]}")
    return None


def _family(name: str) -> Quantity | None:
    """A variable of one rotor group."""
    for prefix, pattern in _FAMILIES.items():
        group = name.removeprefix(prefix)
        if group != name and _GROUP.fullmatch(group):
            return replace(pattern, name=name, desc=f"{pattern.desc} {group}")
    return None


def _examples() -> list[str]:
    """Derivative names, for suggestions."""
    by = ["alpha", "beta", "delta_e", "delta_a", "delta_r", "delta_f", *_RATES]
    return [f"{c}_{b}" for c in _COEFFICIENTS for b in by]
