"""The fuselage, and drag that no surface carries."""

from typing import Literal

from hera_om.aircraft.fields import IDENTIFIER, NAME, Part, item, number


class Fuselage(Part):
    """Fuselage with its nose at the origin and its axis along x."""

    length_m: float = number("length", "m", gt=0)
    width_m: float = number("largest width", "m", gt=0)
    height_m: float = number("largest height", "m", gt=0)
    nose_length_m: float = number("length of the nose ahead of the cylinder", "m", gt=0)
    tail_length_m: float = number("length of the tail behind the cylinder", "m", gt=0)
    model: Literal["munk", "slender"] = item(
        "munk: a moment by Munk's slope times munk_factor; slender: loads by slender-body theory and the flow about "
        "the body at wing and tail, with a lattice that is symmetric and has a wing",
        "munk",
    )
    munk_factor: float = number("share of Munk's moment left by the wing's interference", "", 1.0, ge=0, le=2)


class DragArea(Part):
    """Drag over dynamic pressure of a part that neither lattice, strips nor fuselage carry."""

    name: str = item("name of the part", pattern=NAME)
    value_m2: float = number("drag area of all its pieces together", "m2", ge=0)
    y_m: float | None = number("where it stands on either side", "m", None, ge=0)
    rotor: str | None = item("name of the [[rotor]] group that its pieces move with", None, pattern=IDENTIFIER)
