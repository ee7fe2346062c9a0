"""Flight condition, mission, reference quantities, design variables and lattice density."""

from typing import Literal

from hera_om.aircraft.fields import IDENTIFIER, Part, item, number
from hera_om.aircraft.rotors import FailedRotor


class Reference(Part):
    """Reference quantities; what is absent is derived from the wing's planform."""

    S_m2: float | None = number("area; absent: the wing's", "m2", None, gt=0)
    c_m: float | None = number("chord; absent: the wing's mean aerodynamic chord", "m", None, gt=0)
    b_m: float | None = number("span; absent: the wing's", "m", None, gt=0)
    x_m: float | None = number(
        "moment point; absent: centre of gravity, without masses the quarter of the mean chord", "m", None
    )
    y_m: float | None = number("moment point", "m", None)
    z_m: float | None = number("moment point", "m", None)


class Flight(Part):
    """The flight condition of one analysis."""

    mach: float = number("Mach number", ge=0, lt=1)
    altitude_m: float = number("geopotential altitude in the standard atmosphere", "m", 0.0, ge=-1000, le=20000)
    speed_m_s: float | None = number("true airspeed; absent: mach times the speed of sound", "m/s", None, gt=0)
    density_kg_m3: float | None = number("density; absent: standard atmosphere", "kg/m3", None, gt=0)
    alpha_deg: float = number("angle of attack of the fuselage axis", "deg", 0.0, ge=-90, le=90)
    beta_deg: float = number("sideslip, wind from starboard positive", "deg", 0.0, ge=-90, le=90)
    p_hat: float = number("roll rate p b / 2V", "", 0.0, ge=-1, le=1)
    q_hat: float = number("pitch rate q c / 2V", "", 0.0, ge=-1, le=1)
    r_hat: float = number("yaw rate r b / 2V", "", 0.0, ge=-1, le=1)
    delta_e_deg: float = number("elevator, trailing edge down positive", "deg", 0.0, ge=-90, le=90)
    delta_a_deg: float = number("aileron, right trailing edge down positive", "deg", 0.0, ge=-90, le=90)
    delta_r_deg: float = number("rudder, trailing edge to port positive", "deg", 0.0, ge=-90, le=90)
    delta_f_deg: float = number("flap, trailing edge down positive", "deg", 0.0, ge=-90, le=90)
    failed: tuple[FailedRotor, ...] = item("rotors that have failed", ())


class Mission(Part):
    """What range and structural loads need beside the flight condition."""

    pax: int = number("passengers", "", 0, ge=0)
    climb_fuel_kg: float = number("fuel burnt before the cruise", "kg", ge=0)
    cruise_fuel_kg: float = number("fuel burnt in the cruise at the baseline", "kg", gt=0)
    c_s_1_per_s: float = number("weight flow of fuel per thrust", "1/s", gt=0)
    limit_load_factor: float = number("limit load factor", gt=0, le=20)
    reserve_factor: float = number("required ratio of allowable to limit stress", gt=0, le=10)
    V_C_EAS_m_s: float = number("design cruising speed, equivalent airspeed", "m/s", gt=0)
    V_D_EAS_m_s: float = number("design diving speed, equivalent airspeed", "m/s", gt=0)
    landing_mass_kg: float | None = number("design landing mass; absent: the take-off mass", "kg", None, gt=0)
    ceiling_m: float = number("greatest operating altitude", "m", 7620.0, gt=0, le=18288)
    gear_stroke_m: float = number("stroke of the main gear with its tyres", "m", 0.35, gt=0, le=2)


class Variable(Part):
    """A number of the definition that an optimisation may change."""

    name: str = item("name of the variable in every model and record", pattern=IDENTIFIER)
    path: str = item("dotted path of the number, such as wing.section.kink.y_m")
    lower: float = number("lower bound", "the number's unit")
    upper: float = number("upper bound", "the number's unit")
    ref: float | None = number("scale for the driver; absent: the larger bound", "the number's unit", None, gt=0)


class Lattice(Part):
    """Density of the discretisation."""

    wing_chordwise: int = number("wing panels along the chord", "", 8, ge=1, le=200)
    wing_spanwise: int = number("wing panels along the semispan", "", 32, ge=2, le=1000)
    tail_chordwise: int = number("tail panels along the chord", "", 6, ge=1, le=200)
    tail_spanwise: int = number("tail panels along the semispan", "", 12, ge=1, le=1000)
    fin_chordwise: int | None = number("fin panels along the chord; absent: those of the tail", "", None, ge=1, le=200)
    fin_spanwise: int | None = number("fin panels along the height; absent: those of the tail", "", None, ge=1, le=1000)
    spacing: Literal["cosine", "uniform", "sine"] = item("panels along the span; sine: dense at the tip", "cosine")
    chordwise_spacing: Literal["uniform", "cosine"] = item("panels along the chord", "uniform")
    convention: Literal["ring", "avl"] = item(
        "ring: vortex rings on the twisted camber surface, all bound filaments loaded; avl: as AVL, on the flat chord "
        "surface, spanwise filaments loaded, cores between components",
        "ring",
    )
    wake: Literal["x", "stream"] = item("direction of the trailing vortices: the x axis or the free stream", "x")
    rotor_radial: int = number("rotor stations along the radius", "", 10, ge=2, le=500)
    rotor_azimuthal: int = number("rotor stations around the disk", "", 12, ge=1, le=720)
    box_stations: int = number("wing box stations along the semispan", "", 24, ge=3, le=1000)
