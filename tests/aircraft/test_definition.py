"""The shipped definitions: what they hold, that they survive writing, that frozen numbers are untouched."""

import math
import subprocess
import sys
import tomllib
from pathlib import Path

import pydantic
import pytest

from hera_om.aircraft import (
    definition_hash,
    dumps,
    hub_ys,
    load_aircraft,
    loads,
    numbers,
    replace_numbers,
    shipped,
)
from hera_om.aircraft.definition import Aircraft
from hera_om.aircraft.fields import Part, tables_of
from hera_om.aircraft.reference import wing_quarter_mac

ISA_V, ISA_Q = 158.0, 8149.0  # m/s and Pa at Mach 0.5, 6096 m, as the reference file prints them
GRAVITY = 9.80665


@pytest.fixture(scope="module")
def hera():
    return load_aircraft("hera_like")


@pytest.fixture(scope="module")
def source():
    path = Path(__file__).parents[1] / "reference" / "hera_like.toml"
    return tomllib.loads(path.read_text("utf-8"))


def test_shipped_names():
    assert shipped() == ("atr72", "hera_like", "q400", "rotor_alone", "wing_alone", "wing_rotor", "wing_tail")


@pytest.mark.parametrize("name", shipped())
def test_every_shipped_aircraft_survives_writing(name):
    aircraft = load_aircraft(name)
    assert aircraft.name == name
    again = loads(dumps(aircraft))
    assert again == aircraft
    assert definition_hash(again) == definition_hash(aircraft)
    assert dumps(again) == dumps(aircraft)


def test_a_path_loads_as_the_name_does(tmp_path, hera):
    file = tmp_path / "copy.toml"
    file.write_text("\ufeff" + dumps(hera), "utf-8")  # some editors write a byte order mark
    assert load_aircraft(file) == load_aircraft(str(file)) == hera


def test_hash_sees_every_kind_of_change_and_nothing_else(hera):
    text = dumps(hera)
    base = definition_hash(hera)
    assert len(base) == 64
    assert definition_hash(loads("# a comment\n" + text)) == base
    assert definition_hash(loads(text.replace("rpm = 1020.0", "rpm = 1020"))) == base
    assert definition_hash(replace_numbers(hera, {"flight.alpha_deg": -0.0})) == base
    for old, new in [
        ("rpm = 1020.0", "rpm = 1020.0000000001"),
        ("blades = 6", "blades = 5"),
        ("NACA 0012", "flat"),
    ]:
        assert old in text
        assert definition_hash(loads(text.replace(old, new))) != base


def test_hash_is_the_same_in_every_process(hera):
    code = "from hera_om.aircraft import *; print(definition_hash(load_aircraft('hera_like')))"
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert out.stdout.strip() == definition_hash(hera)


def test_reading_a_definition_imports_nothing_heavy():
    code = (
        "import sys, hera_om.core.errors, hera_om.core.registry; from hera_om.aircraft import load_aircraft;"
        "load_aircraft('hera_like');"
        "print([m for m in ('jax', 'numpy', 'scipy', 'openmdao', 'pandas') if m in sys.modules])"
    )
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert out.stdout.strip() == "[]"


def test_definition_is_immutable(hera):
    with pytest.raises(pydantic.ValidationError):
        hera.flight.mach = 0.6
    with pytest.raises(pydantic.ValidationError):
        hera.wing.section[0].chord_m = 1.0


def test_every_table_is_strict_frozen_and_closed():
    tables = [part for _, part, _ in tables_of(Aircraft)]
    assert len(tables) > 20
    for part in tables:
        assert issubclass(part, Part)
        assert (part.model_config["strict"], part.model_config["frozen"]) == (True, True)
        assert (part.model_config["extra"], part.model_config["allow_inf_nan"]) == ("forbid", False)


# --- hera_like against the file it was converted from


def test_values_are_those_of_the_reference_file(hera, source):
    got = numbers(hera)
    wing = source["wing"]
    expected = {
        "flight.mach": source["mission"]["cruise_mach"],
        "flight.altitude_m": source["mission"]["cruise_altitude_m"],
        "reference.S_m2": wing["S_ref_m2"],
        "wing.section.tip.y_m": wing["semispan_m"],
        "wing.section.kink.y_m": wing["y_kink_m"],
        "wing.fuselage_joint_y_m": wing["y_fuselage_joint_m"],
        "wing.section.kink.sweep_quarter_deg": wing["sweep_quarter_inner_deg"],
        "wing.section.tip.sweep_quarter_deg": wing["sweep_quarter_outer_deg"],
        "wing.section.kink.dihedral_deg": wing["dihedral_inner_deg"],
        "wing.section.tip.dihedral_deg": wing["dihedral_outer_deg"],
        "htail.scale": 1.0,
    }
    for section in ("root", "kink", "tip"):
        expected[f"wing.section.{section}.chord_m"] = wing[f"chord_{section}_m"]
        expected[f"wing.section.{section}.thickness"] = wing[f"thickness_{section}"]
        expected[f"wing.section.{section}.twist_deg"] = wing.get(f"twist_{section}_deg", 0.0)
    for surface in ("wing", "htail", "vtail"):
        expected |= {f"{surface}.polar.{k}": v for k, v in source[surface]["profile_polar"].items()}
    for control in ("wing.aileron", "wing.flap", "htail.elevator", "vtail.rudder"):
        surface, name = control.split(".")
        table = {k: v for k, v in source[surface][name].items() if k != "full_span"}
        expected |= {f"{surface}.control.{name}.{k}": v for k, v in table.items()}
    for table in ("mission", "htail", "vtail", "fuselage"):
        skip = ("cruise_mach", "cruise_altitude_m")
        floats = {k: v for k, v in source[table].items() if isinstance(v, float) and k not in skip}
        expected |= {f"{table}.{k}": v for k, v in floats.items()}
    floats = {k: v for k, v in wing["structure"].items() if isinstance(v, float)}
    expected |= {f"wing.structure.{k}": v for k, v in floats.items()}
    for rotor in source["rotor"]:
        expected |= {f"rotor.{rotor['name']}.{k}": v for k, v in rotor.items() if isinstance(v, float)}
    for key in ("r", "c", "twist_deg", "thickness"):
        expected |= {f"blade.main.{key}.{i}": v for i, v in enumerate(source["blade"][key])}
    expected |= {f"blade.main.polar.{k}": v for k, v in source["blade"]["polar"].items()}
    for item in source["mass"][0]["items"]:
        units = {"m": "m_kg", **{k: f"{k}_m" for k in ("x", "y", "z", "kx", "ky")}}
        expected |= {f"mass.{item['name']}.{units[k]}": v for k, v in item.items() if k != "name"}
    for path, value in expected.items():
        assert got[path] == value, path
    assert len(expected) > 200
    assert [a.value_m2 for a in hera.drag_area] == [a["value_m2"] for a in source["drag_area"]]
    for name, bounds in source["design_variables"].items():
        v = next(v for v in hera.variables if name.startswith(v.name))
        assert [v.lower, got[v.path], v.upper] == bounds


def test_tags_stay_beside_the_numbers():
    text = (Path(sys.modules["hera_om.aircraft"].__file__).parent / "data" / "hera_like.toml").read_text("utf-8")
    reference = (Path(__file__).parents[1] / "reference" / "hera_like.toml").read_text("utf-8")
    for tag in ("[P]", "[ATR]", "[FAST]", "[RC]", "[HERA]", "[TUD]", "[D]", "[C]"):
        assert text.count(tag) >= reference.count(tag) - 2, tag  # a comment or two were merged


def test_mass_totals_fix_the_convention_of_the_radii(hera):
    items = hera.mass
    mass = sum(i.m_kg for i in items)
    x = sum(i.m_kg * i.x_m for i in items) / mass
    z = sum(i.m_kg * i.z_m for i in items) / mass
    Ixx = sum(i.m_kg * (i.ky_m**2 + i.kz_m**2 + (i.z_m - z) ** 2) for i in items)
    Iyy = sum(i.m_kg * (i.kx_m**2 + i.kz_m**2 + (i.x_m - x) ** 2 + (i.z_m - z) ** 2) for i in items)
    Izz = sum(i.m_kg * (i.kx_m**2 + i.ky_m**2 + (i.x_m - x) ** 2) for i in items)
    Ixz = sum(i.m_kg * (i.x_m - x) * (i.z_m - z) for i in items)
    assert mass == 28153.0
    assert (x, z) == pytest.approx((12.0485, 0.343), abs=4e-4)
    assert (Ixx, Iyy, Izz, Ixz) == pytest.approx((4.02e5, 5.88e5, 9.46e5, 2.24e4), rel=2e-3)
    assert (x - _leading_edge_of_mac(hera)) / 2.4755 == pytest.approx(0.357, abs=2e-3)


def _leading_edge_of_mac(aircraft):
    return wing_quarter_mac(aircraft.wing).x - 0.25 * aircraft.reference.c_m


def test_rough_figures_that_the_file_states(hera, source):
    checks = source["rough_checks"]
    cruise_mass = sum(m.m_kg for m in hera.mass) - hera.mission.climb_fuel_kg
    weight = cruise_mass * GRAVITY
    assert weight / (ISA_Q * hera.reference.S_m2) == pytest.approx(checks["CL_cruise"], rel=0.02)
    thrust = sum(2 * r.count_per_side * r.thrust_design_N for r in hera.rotor)
    assert 15.0 < weight / thrust < 17.5  # "the baseline L/D is near 16"
    advance = [ISA_V / (r.rpm / 60.0 * r.diameter_m) for r in hera.rotor]
    assert advance == pytest.approx([2.38, 2.39], abs=0.01)
    assert sum(a.value_m2 for a in hera.drag_area) == pytest.approx(0.59)
    assert hera.htail.x_quarter_mac_m - wing_quarter_mac(hera.wing).x == pytest.approx(13.7, abs=0.02)


def test_rotor_clearances_that_the_file_states(hera):
    hybrid, electric = hera.rotor
    low = next(v for v in hera.variables if v.name == "y_prop")
    gap = low.lower - 0.5 * electric.diameter_m - (hybrid.y_m + 0.5 * hybrid.diameter_m)
    assert gap == pytest.approx(0.19, abs=0.005)
    outer = hub_ys(electric)[-1] - electric.y_m + low.upper + 0.5 * electric.diameter_m
    assert hera.wing.section[-1].y_m - outer == pytest.approx(0.3, abs=0.02)


# --- the small examples


def test_tail_of_the_example_is_the_trapezoid_of_its_source():
    tail = load_aircraft("wing_tail").htail
    span = math.sqrt(tail.aspect_ratio * tail.S_m2)
    root = 2.0 * tail.S_m2 / (span * (1.0 + tail.taper))
    y_mac = span / 6.0 * (1.0 + 2.0 * tail.taper) / (1.0 + tail.taper)
    slope = math.tan(math.radians(tail.sweep_quarter_deg))
    x_root = tail.x_quarter_mac_m - y_mac * slope - 0.25 * root
    x_tip = x_root + 0.25 * root + 0.5 * span * slope - 0.25 * root * tail.taper
    found = (0.5 * span, root, root * tail.taper, x_root, x_tip)
    assert found == pytest.approx((3.655, 1.95, 1.25, 14.60, 15.125), abs=1e-12)


def test_drag_law_of_the_lone_rotor_is_that_of_its_source():
    p = load_aircraft("rotor_alone").blade[0].polar
    for cl in (-0.5, 0.0, 0.7, 2.0):
        assert p.cd_min + p.k * (cl - p.cl_at_cd_min) ** 2 == pytest.approx(
            0.008 - 0.003 * cl + 0.01 * cl**2, abs=1e-15
        )


def test_twist_of_the_lone_rotor_is_its_constant_pitch():
    aircraft = load_aircraft("rotor_alone")
    rotor, blade = aircraft.rotor[0], aircraft.blade[0]
    assert aircraft.blade_of(rotor) is blade
    for r, twist in zip(blade.r, blade.twist_deg, strict=True):
        pitch = math.tan(math.radians(rotor.beta75_deg + twist)) * 2.0 * math.pi * r * 0.5 * rotor.diameter_m
        assert pitch == pytest.approx(1.0, abs=1e-8)


# --- materials


def test_shipped_material_is_copied_in_and_an_own_one_wins(hera):
    assert [m.name for m in hera.material] == ["Al7075-T6"]
    assert hera.wing_material().Fcy_Pa == 469.0e6
    own = dumps(hera).replace("Fcy_Pa = 469000000.0", "Fcy_Pa = 400e6")
    assert loads(own).wing_material().Fcy_Pa == 400.0e6
    assert len(loads(own).material) == 1


def test_no_structure_no_material():
    with pytest.raises(ValueError, match="no wing structure"):
        load_aircraft("wing_alone").wing_material()


def test_hubs_of_a_group():
    hybrid, electric = load_aircraft("hera_like").rotor
    assert hub_ys(hybrid) == (4.10,)
    assert hub_ys(electric) == (8.00, 10.75)
