"""Lifting surfaces beside wing and tails: any number of them, by sections anywhere in space."""

from typing import Literal

from pydantic import Field

from hera_om.aircraft.fields import NAME, Part, item, number
from hera_om.aircraft.polars import PolarTable
from hera_om.aircraft.spacing import LAW
from hera_om.aircraft.surfaces import AIRFOIL, STRIP_SPACING, STRIPS, Polar

COMMANDS = ("delta_e", "delta_a", "delta_r", "delta_f")
_LAWS = "uniform, cosine, sine (dense at the end), sine-inner (dense at the start) or AVL's number as text"


class SurfaceSection(Part):
    """A station of a further surface."""

    name: str = item("name of the section, used in paths", pattern=NAME)
    x_le_m: float = number("leading edge", "m")
    y_m: float = number("leading edge; 0 on a surface in the symmetry plane", "m", 0.0, ge=-1000, le=1000)
    z_m: float = number("leading edge", "m", 0.0)
    chord_m: float = number("chord, along x", "m", gt=0, le=1000)
    twist_deg: float = number("incidence of the section, nose up about its span", "deg", 0.0, ge=-90, le=90)
    airfoil: str = item("mean line: flat, NACA 4 or 5 digits, an [[airfoil]] or a .dat file", "flat", pattern=AIRFOIL)
    strips: int | None = number(STRIPS, "", None, ge=1, le=1000)
    spacing: str | None = item(STRIP_SPACING, None, pattern=LAW)


class SurfaceControl(Part):
    """A control of a further surface, which turns what lies behind its hinge line.

    The deflection is gain times the command. A positive one turns by the right-hand rule about the hinge line as it
    runs from the first section towards the last: trailing edge down on a surface that runs to starboard, trailing
    edge to STARBOARD on a fin that runs up. A rudder on such a fin therefore has a negative gain. Hinge fraction and
    gain go linearly from the inner to the outer end.
    """

    name: str = item("name of the control, used in paths", pattern=NAME)
    command: Literal["delta_e", "delta_a", "delta_r", "delta_f"] = item("command that the control answers to")
    inner: float = number("inner end as a fraction of the span, measured along the sections in y and z", "", 0.0, ge=0)
    outer: float = number("outer end as a fraction of the span", "", 1.0, le=1)
    hinge: float = number("hinge line at the inner end as a fraction of the chord", ge=0, lt=1)
    hinge_outer: float | None = number("hinge line at the outer end; absent: as at the inner", "", None, ge=0, lt=1)
    gain: float = number("deflection per unit of the command, at the inner end", "", 1.0)
    gain_outer: float | None = number("the same at the outer end; absent: as at the inner", "", None)
    mirror: float | None = number(
        "deflection of the mirrored half: 1 its mirror image, -1 opposed; absent: -1 for delta_a and delta_r, else 1",
        "",
        None,
    )
    axis_x: float | None = number("axis of the rotation instead of the hinge line; all three or none", "", None)
    axis_y: float | None = number("axis of the rotation", "", None)
    axis_z: float | None = number("axis of the rotation", "", None)
    limit_deg: float | None = number("largest deflection either way; absent: none", "deg", None, gt=0, le=90)


class Surface(Part):
    """A further lifting surface, by straight segments between sections."""

    name: str = item("name of the surface, used in paths", pattern=NAME)
    side: Literal["both", "plane", "one"] = item(
        "both: given for y >= 0 and mirrored; plane: stands in the plane y = 0, such as a fin; one: as given, no image",
        "both",
    )
    component: int | None = number(
        "number of its component: where [lattice] follows AVL, vortices of others have a core; absent: its own",
        "",
        None,
        ge=0,
    )
    incidence_deg: float = number("setting angle added to every section's twist", "deg", 0.0, ge=-90, le=90)
    section: tuple[SurfaceSection, ...] = Field(description="sections, from the root to the tip", min_length=2)
    control: tuple[SurfaceControl, ...] = item("controls", ())
    polar: Polar | None = item("profile drag; absent: none", None)
    polar_table: PolarTable | None = item("profile drag and stall from a table, instead of polar", None)
    chordwise: int | None = number("panels along the chord; absent: the tail's of [lattice]", "", None, ge=1, le=200)
    spanwise: int | None = number("strips of the whole; absent: the tail's of [lattice]", "", None, ge=1, le=1000)
    chordwise_spacing: str | None = item(f"panels along the chord: {_LAWS}; absent: [lattice]", None, pattern=LAW)
    spacing: str | None = item(f"strips along the span: {_LAWS}; absent: [lattice]", None, pattern=LAW)
