"""Lifting surfaces: the wing by sections, the tails as trapezoids, their controls and section polars."""

from pydantic import Field

from hera_om.aircraft.fields import NAME, Part, item, number
from hera_om.aircraft.polars import PolarTable
from hera_om.aircraft.spacing import LAW
from hera_om.aircraft.structure import WingStructure

NACA = r"NACA (00[0-9]{2}|[1-9][1-9][0-9]{2}|[1-9][1-5][01][0-9]{2})"
AIRFOIL = rf"^({NACA}|[A-Za-z][A-Za-z0-9_-]*)$"
AIRFOIL_TEXT = (
    "'flat', a NACA 4- or 5-digit name such as 'NACA 2412' or 'NACA 43018', the name of an [[airfoil]], "
    "or the path of a coordinate file that ends in .dat"
)
AIRFOIL_MEANING = (
    "mean line: flat, NACA 4 or 5 digits, an [[airfoil]] or a .dat file; the thickness that counts is the key thickness"
)
STRIPS = "strips of the segment outboard of the section; absent: shared out by the surface's number"
STRIP_SPACING = (
    "spacing of these strips within the segment, words or numbers as for a [[surface]]; absent: the part of the "
    "surface's own law that they stand for"
)


class Polar(Part):
    """Section drag polar cd = cd_min + k (cl - cl_at_cd_min)^2 of a surface, up to cl_max."""

    cd_min: float = number("least section drag coefficient", gt=0, lt=1)
    cl_at_cd_min: float = number("section lift coefficient at the least drag", ge=-2, le=2)
    k: float = number("curvature of the polar", ge=0)
    re: float = number("Reynolds number of the polar", gt=0)
    cl_max: float = number("largest section lift coefficient", gt=0, le=5)


class Section(Part):
    """A station of the wing. All but the first are placed by sweep and dihedral, or by x_le_m and z_m."""

    name: str = item("name of the section, used in paths", pattern=NAME)
    y_m: float = number("distance from the symmetry plane; 0 for the first section", "m", ge=0, le=1000)
    chord_m: float = number("chord", "m", gt=0, le=1000)
    twist_deg: float = number("geometric twist, nose up", "deg", 0.0, ge=-45, le=45)
    thickness: float = number("largest thickness over chord", gt=0, lt=0.5)
    airfoil: str = item(AIRFOIL_MEANING, pattern=AIRFOIL)
    sweep_quarter_deg: float | None = number(
        "sweep of the quarter-chord line of the segment inboard of the section", "deg", None, gt=-70, lt=70
    )
    dihedral_deg: float | None = number("dihedral of the segment inboard of the section", "deg", None, gt=-70, lt=70)
    x_le_m: float | None = number("position of the leading edge, instead of the sweep", "m", None)
    z_m: float | None = number("height of the section, instead of the dihedral", "m", None)
    strips: int | None = number(STRIPS, "", None, ge=1, le=1000)
    spacing: str | None = item(STRIP_SPACING, None, pattern=LAW)


class Control(Part):
    """A trailing-edge control over a part of the wing's span."""

    y0_m: float = number("inner end", "m", ge=0)
    y1_m: float = number("outer end", "m", gt=0)
    hinge: float = number("hinge line as a fraction of the chord", gt=0, lt=1)
    limit_deg: float = number("largest deflection either way", "deg", gt=0, le=90)
    gain: float = number("deflection per unit of the command", "", 1.0)


class WingControls(Part):
    """Controls of the wing."""

    aileron: Control | None = item("ailerons, antisymmetric, positive right trailing edge down", None)
    flap: Control | None = item("flaps, symmetric, positive trailing edge down", None)


class FuelTank(Part):
    """Extent of the fuel in the wing, between the spars."""

    y0_m: float = number("inner end", "m", ge=0)
    y1_m: float = number("outer end", "m", gt=0)


class Wing(Part):
    """The wing, both sides alike, by straight segments between sections."""

    x_le_root_m: float = number("leading edge of the first section", "m", 0.0)
    z_root_m: float = number("height of the first section", "m", 0.0)
    incidence_deg: float = number("setting angle added to every section's twist", "deg", 0.0, ge=-30, le=30)
    fuselage_joint_y_m: float = number("where the wing leaves the fuselage", "m", 0.0, ge=0)
    section: tuple[Section, ...] = Field(description="sections from the root to the tip", min_length=2)
    polar: Polar | None = item("profile drag; absent: none", None)
    polar_table: PolarTable | None = item("profile drag and stall from a table, instead of polar", None)
    control: WingControls = item("trailing-edge controls", WingControls())
    fuel_tank: FuelTank | None = item("fuel tank", None)
    structure: WingStructure | None = item("wing box", None)


class TailControl(Part):
    """A trailing-edge control over the whole span of a tail."""

    hinge: float = number("hinge line as a fraction of the chord", gt=0, lt=1)
    limit_deg: float = number("largest deflection either way", "deg", gt=0, le=90)
    gain: float = number("deflection per unit of the command", "", 1.0)


class HTailControls(Part):
    """Controls of the horizontal tail."""

    elevator: TailControl | None = item("elevator, positive trailing edge down", None)


class VTailControls(Part):
    """Controls of the vertical tail."""

    rudder: TailControl | None = item("rudder, positive trailing edge to port", None)


class HTail(Part):
    """Horizontal tail: a trapezoid, both sides alike. Area goes with the square of scale."""

    S_m2: float = number("area of both sides at scale 1", "m2", gt=0)
    aspect_ratio: float = number("span^2 / area", gt=0, le=50)
    taper: float = number("tip chord over root chord", gt=0, le=2)
    sweep_quarter_deg: float = number("sweep of the quarter-chord line", "deg", 0.0, gt=-70, lt=70)
    dihedral_deg: float = number("dihedral", "deg", 0.0, gt=-70, lt=70)
    incidence_deg: float = number("setting angle, nose up", "deg", 0.0, ge=-30, le=30)
    scale: float = number("linear scale; the quarter of the mean chord stays where it is", "", 1.0, gt=0)
    airfoil: str = item(AIRFOIL_MEANING, "flat", pattern=AIRFOIL)
    thickness: float = number("largest thickness over chord", "", 0.12, gt=0, lt=0.5)
    x_quarter_mac_m: float = number("quarter of the mean aerodynamic chord", "m")
    z_m: float = number("height of the root", "m", 0.0)
    polar: Polar | None = item("profile drag; absent: none", None)
    polar_table: PolarTable | None = item("profile drag and stall from a table, instead of polar", None)
    control: HTailControls = item("trailing-edge controls", HTailControls())
    mass_per_area_kg_m2: float | None = number("mass per area, for scaling", "kg/m2", None, gt=0)


class VTail(Part):
    """Vertical tail: one trapezoidal panel in the symmetry plane. Area goes with the square of scale."""

    S_m2: float = number("area of the panel at scale 1", "m2", gt=0)
    aspect_ratio: float = number("height^2 / area", gt=0, le=50)
    taper: float = number("tip chord over root chord", gt=0, le=2)
    sweep_quarter_deg: float = number("sweep of the quarter-chord line", "deg", 0.0, gt=-70, lt=70)
    scale: float = number("linear scale; the root's leading edge stays where it is", "", 1.0, gt=0)
    airfoil: str = item(AIRFOIL_MEANING, "flat", pattern=AIRFOIL)
    thickness: float = number("largest thickness over chord", "", 0.12, gt=0, lt=0.5)
    x_le_root_m: float = number("leading edge of the root", "m")
    z_root_m: float = number("height of the root", "m", 0.0)
    polar: Polar | None = item("profile drag; absent: none", None)
    polar_table: PolarTable | None = item("profile drag and stall from a table, instead of polar", None)
    control: VTailControls = item("trailing-edge controls", VTailControls())
    mass_per_area_kg_m2: float | None = number("mass per area, for scaling", "kg/m2", None, gt=0)
