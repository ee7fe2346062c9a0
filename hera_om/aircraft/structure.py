"""The wing box concept and the materials."""

import tomllib
from functools import lru_cache
from importlib import resources
from typing import Literal

from hera_om.aircraft.fields import NAME, Part, item, number


class WingStructure(Part):
    """Wing box between two spars: caps and stringers given, skins, webs and ribs sized."""

    material: str = item("name of a [[material]] of the definition, or of a shipped one", pattern=NAME)
    front_spar: float = number("front spar as a fraction of the chord", gt=0, lt=1)
    rear_spar: float = number("rear spar as a fraction of the chord", gt=0, lt=1)
    rib_pitch_m: float = number("distance between ribs", "m", gt=0)
    stringer_pitch_m: float = number("distance between stringers", "m", gt=0)
    A_cap_root_m2: float = number("area of one spar cap at the root; four caps", "m2", gt=0)
    A_stringer_root_m2: float = number("area of one stringer at the root", "m2", gt=0)
    t_min_skin_m: float = number("least thickness of a sheet", "m", gt=0)
    t_increment_m: float = number("step of the thicknesses that can be bought", "m", ge=0)
    t_step_max_m: float = number("largest step of a bought thickness between neighbouring bays", "m", 0.0005, gt=0)
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


@lru_cache(maxsize=1)
def shipped_materials() -> dict[str, dict[str, str | float]]:
    """The tables of the shipped materials by name."""
    text = (resources.files("hera_om.aircraft") / "data" / "materials.toml").read_text("utf-8")
    return {str(table["name"]): table for table in tomllib.loads(text)["material"]}
