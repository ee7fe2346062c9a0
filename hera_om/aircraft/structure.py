"""The wing box concept and the materials."""

import tomllib
from functools import lru_cache
from importlib import resources
from typing import Annotated, Any, Literal

from pydantic import Field

from hera_om.aircraft.fields import NAME, Constant, Part, item, number

_Angle = Annotated[float, Field(gt=-180, le=180), Constant]


class WingStructure(Part):
    """Wing box between two spars: caps and stringers given, skins, webs and ribs sized."""

    material: str = item("name of a [[material]] or [[laminate]] of the definition, or of a shipped one", pattern=NAME)
    front_spar: float = number("front spar as a fraction of the chord", gt=0, lt=1)
    rear_spar: float = number("rear spar as a fraction of the chord", gt=0, lt=1)
    rib_pitch_m: float = number("distance between ribs", "m", gt=0)
    stringer_pitch_m: float = number("distance between stringers", "m", gt=0)
    A_cap_root_m2: float = number("area of one spar cap at the root; four caps", "m2", gt=0)
    A_stringer_root_m2: float = number("area of one stringer at the root", "m2", gt=0)
    t_min_skin_m: float = number("least thickness of a sheet", "m", gt=0)
    t_increment_m: float = number("step of the thicknesses that can be bought", "m", ge=0)
    t_step_max_m: float = number("largest step of a bought thickness between neighbouring bays", "m", 0.0005, gt=0)
    aeroelastic: bool = item(
        "whether bending and twist of the wing, over its shape in the cruise, change its loads", False
    )
    primary_fraction: float | None = number(
        "share of sized primary structure in what it stands for; absent: what is beside it is built up",
        "",
        None,
        gt=0,
        le=1,
    )
    flap_slots: int = number("slots of the flaps, 1 or 2: elements that move beside each other", "", 1, ge=1, le=2)
    flap_support: Literal["hinge", "link", "track"] = item(
        "what the flaps hang on; they travel unless it is a hinge", "hinge"
    )
    gear_on_wing: bool = item("whether the main gear hangs on the wing or its nacelles", False)
    mass_total_baseline_kg: float = number("mass of the whole wing at the baseline", "kg", gt=0)
    mass_remainder_kg: float | None = number(
        "mass beside what is sized and built up, frozen; absent: computed once at the baseline",
        "kg",
        None,
    )


class Material(Part):
    """An isotropic material with its allowables."""

    name: str = item("name of the material", pattern=NAME)
    E_Pa: float = number("Young's modulus", "Pa", gt=0)
    G_Pa: float = number("shear modulus", "Pa", gt=0)
    nu: float = number("Poisson's ratio", gt=-1, lt=0.5)
    rho_kg_m3: float = number("density", "kg/m3", gt=0)
    Fty_Pa: float = number("yield strength in tension", "Pa", gt=0)
    Fcy_Pa: float = number("yield strength in compression", "Pa", gt=0)
    Ftu_Pa: float = number("ultimate strength in tension", "Pa", gt=0)
    Fsu_Pa: float = number("ultimate strength in shear", "Pa", gt=0)


class Laminate(Part):
    """A symmetric laminate of equal unidirectional plies; it fails with its first ply, by Tsai and Wu."""

    name: str = item("name of the laminate", pattern=NAME)
    E1_Pa: float = number("Young's modulus of the ply along its fibres", "Pa", gt=0)
    E2_Pa: float = number("Young's modulus of the ply across its fibres", "Pa", gt=0)
    G12_Pa: float = number("shear modulus of the ply", "Pa", gt=0)
    nu12: float = number("Poisson's ratio of the ply, strain across over strain along its fibres", gt=-1, lt=1)
    rho_kg_m3: float = number("density", "kg/m3", gt=0)
    Xt_Pa: float = number("strength of the ply along its fibres in tension", "Pa", gt=0)
    Xc_Pa: float = number("strength of the ply along its fibres in compression", "Pa", gt=0)
    Yt_Pa: float = number("strength of the ply across its fibres in tension", "Pa", gt=0)
    Yc_Pa: float = number("strength of the ply across its fibres in compression", "Pa", gt=0)
    S_Pa: float = number("strength of the ply in shear", "Pa", gt=0)
    angles_deg: tuple[_Angle, ...] = Field(
        min_length=1, description="angles of the plies from the span, from a face to the middle plane [deg]"
    )


@lru_cache(maxsize=1)
def shipped_materials() -> dict[str, tuple[str, dict[str, Any]]]:
    """The shipped materials by name: which array of tables each belongs to, and its table."""
    text = (resources.files("hera_om.aircraft") / "data" / "materials.toml").read_text("utf-8")
    arrays = tomllib.loads(text)
    return {str(table["name"]): (kind, table) for kind, tables in arrays.items() for table in tables}
