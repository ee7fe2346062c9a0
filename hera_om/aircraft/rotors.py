"""Rotor groups and their blades."""

from typing import Annotated, Any, Literal

from pydantic import Field

from hera_om.aircraft.fields import IDENTIFIER, NAME, Part, item, number
from hera_om.aircraft.polars import BladePolarTable

_Radius = Annotated[float, Field(gt=0, le=1)]
_Positive = Annotated[float, Field(gt=0, lt=2)]
_Angle = Annotated[float, Field(ge=-90, le=90)]
_Thickness = Annotated[float, Field(gt=0, le=1)]


class Rotor(Part):
    """A group of equal rotors, mirrored to the other side; y_m = 0 is one rotor in the symmetry plane."""

    name: str = item("name of the group, used in paths and in names such as theta_<name>", pattern=IDENTIFIER)
    count_per_side: int = number("rotors on one side", "", 1, ge=1, le=50)
    y_m: float = number("hub of the inner rotor", "m", ge=0)
    spacing_m: float | None = number("distance between hubs; required with more than one", "m", None, gt=0)
    x_ahead_of_leading_edge_m: float | None = number("hub ahead of the wing's leading edge at its y", "m", None)
    z_offset_m: float | None = number("hub above the wing's leading edge at its y", "m", None)
    x_m: float | None = number("hub, instead of the position by the wing", "m", None)
    z_m: float | None = number("hub height, instead of the position by the wing", "m", None)
    diameter_m: float = number("diameter", "m", gt=0)
    nacelle_diameter_m: float = number(
        "diameter of a nacelle behind it, which slows the disk and around which the slipstream flows", "m", 0.0, ge=0
    )
    blades: int = number("number of blades", ge=2, le=20)
    rpm: float = number("speed of rotation, revolutions a minute", "rpm", gt=0)
    axis_incidence_deg: float = number("tilt of the axis, thrust upward positive", "deg", 0.0, gt=-90, lt=90)
    sense: Literal["inboard-up", "outboard-up"] = item("rotation seen from behind", "inboard-up")
    beta75_deg: float = number("blade pitch at 75 % of the radius", "deg", ge=-90, le=90)
    beta75_min_deg: float | None = number("least blade pitch of the trim", "deg", None, ge=-90, le=90)
    beta75_max_deg: float | None = number("largest blade pitch of the trim", "deg", None, ge=-90, le=90)
    thrust_design_N: float | None = number("design thrust of one rotor; sets the split", "N", None, gt=0)
    polar_inertia_kgm2: float = number("polar moment of inertia of what turns in one rotor", "kg*m2", 0.0, ge=0)
    shaft_power_max_W: float | None = number("shaft power of one rotor", "W", None, gt=0)
    blade: str = item("name of a [[blade]]", pattern=NAME)


class BladePolar(Part):
    """Section polar of a blade: linear lift up to cl_max, cd = cd_min + k (cl - cl_at_cd_min)^2."""

    cl_alpha_per_rad: float = number("section lift slope without compressibility", "1/rad", gt=0, le=10)
    alpha_zero_lift_deg: float = number("angle of zero lift", "deg", ge=-20, le=20)
    cd_min: float = number("least section drag coefficient", gt=0, lt=1)
    cl_at_cd_min: float = number("section lift coefficient at the least drag", ge=-2, le=2)
    k: float = number("curvature of the polar", ge=0)
    cl_max: float = number("largest section lift coefficient; a large one means no stall", gt=0)
    compressible: bool = item("Prandtl-Glauert on the lift slope", True)


class Blade(Part):
    """A blade by stations from the hub to the tip; all arrays have the same length."""

    name: str = item("name of the blade", pattern=NAME)
    hub: float = number("hub radius over tip radius", ge=0, lt=1)
    r: tuple[_Radius, ...] = Field(description="radius over tip radius, increasing [-]", min_length=2)
    c: tuple[_Positive, ...] = Field(description="chord over tip radius [-]", min_length=2)
    twist_deg: tuple[_Angle, ...] = Field(description="twist relative to 75 % of the radius [deg]", min_length=2)
    thickness: tuple[_Thickness, ...] = Field(description="largest thickness over chord [-]", min_length=2)
    polar: BladePolar | None = item("section polar of the whole blade by seven numbers", None)
    polar_table: BladePolarTable | None = item("section polar of the whole blade by a table, instead of polar", None)
    stall_delay: bool = item("delay of stall by rotation, after Du and Selig", False)
    tip_loss: bool = item("Prandtl's loss factor at the tip", True)
    hub_loss: bool = item("Prandtl's loss factor at the hub", True)


class FailedRotor(Part):
    """A rotor that has failed: it turns freely without torque (windmilling), stands still at the pitch of its group
    (stopped), or stands still at the pitch at which the air exerts no torque on it (feathered).
    """

    rotor: str = item("name of its [[rotor]] group", pattern=IDENTIFIER)
    number: int = number("which of the group on its side, 1 being the inner one", ge=1, le=50)
    side: Literal["starboard", "port", "both"] = item("its side; one side alone needs both halves, as in analyze")
    state: Literal["windmilling", "feathered", "stopped"] = item("what it does")

    @property
    def name(self) -> str:
        """What stands for it in paths."""
        return f"{self.rotor}_{self.number}_{self.side}"

    @property
    def halves(self) -> tuple[int, ...]:
        """0 for starboard, 1 for port."""
        return {"starboard": (0,), "port": (1,), "both": (0, 1)}[self.side]


def hub_ys(rotor: Rotor) -> tuple[Any, ...]:
    """Distances of a group's hubs from the symmetry plane, inner first [m]; works on traced numbers."""
    spacing = 0.0 if rotor.spacing_m is None else rotor.spacing_m
    return tuple(rotor.y_m + i * spacing for i in range(rotor.count_per_side))
