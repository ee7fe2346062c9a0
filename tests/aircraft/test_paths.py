"""Numbers by path, and the split of an aircraft into structure and numbers."""

import time

import jax
import jax.numpy as jnp
import pytest
from openmdao.utils.units import valid_units

from hera_om.aircraft import (
    blank,
    dumps,
    fill,
    load_aircraft,
    loads,
    numbers,
    reference_S,
    replace_numbers,
    shipped,
    unit_of,
    variable_box,
)

PATHS = {
    "rotor.electric.y_m": 8.0,
    "wing.section.kink.y_m": 5.6,
    "wing.section.tip.twist_deg": -3.0,
    "htail.scale": 1.0,
    "wing.structure.A_cap_root_m2": 3.0e-3,
    "mass.battery.x_m": 11.3,
    "blade.main.twist_deg.3": 11.02,
    "material.Al7075-T6.Fty_Pa": 476.0e6,
    "wing.control.aileron.gain": 1.0,
}


@pytest.fixture(scope="module")
def hera():
    return load_aircraft("hera_like")


def test_numbers_are_floats_by_path(hera):
    found = numbers(hera)
    assert {p: found[p] for p in PATHS} == PATHS
    assert all(type(v) is float for v in found.values())
    absent = {
        "rotor.hybrid.blades",
        "lattice.wing_chordwise",
        "flight.speed_m_s",
        "rotor.hybrid.name",
        "blade.main.r",
    }
    assert not absent & set(found)


@pytest.mark.parametrize("name", shipped())
def test_fill_undoes_the_split_and_blank_has_no_numbers(name):
    aircraft = load_aircraft(name)
    empty = blank(aircraft)
    assert set(numbers(empty).values()) == {0.0}
    assert list(numbers(empty)) == list(numbers(aircraft))
    assert fill(empty, list(numbers(aircraft).values())) == aircraft


def test_structure_is_the_same_for_other_numbers_and_differs_for_other_structure(hera):
    other = replace_numbers(hera, {"htail.scale": 1.2, "blade.main.c.2": 0.2})
    assert other != hera
    assert blank(other) == blank(hera)
    assert hash(blank(other)) == hash(blank(hera))
    text = dumps(hera)
    for old, new in [("blades = 6", "blades = 5"), ("wing_chordwise = 8", "wing_chordwise = 9")]:
        assert blank(loads(text.replace(old, new))) != blank(hera)
    with_speed = load_aircraft("hera_like", {"flight.speed_m_s": 150.0})
    assert blank(with_speed) != blank(hera)  # an absent number stays absent
    assert blank(hera).flight.speed_m_s is None


@pytest.mark.parametrize("path", PATHS)
def test_replacing_changes_one_number_and_not_the_original(hera, path):
    before = numbers(hera)
    changed = numbers(replace_numbers(hera, {path: 0.123}))
    assert {p for p in before if before[p] != changed[p]} == {path}
    assert changed[path] == 0.123
    assert numbers(hera) == before


def test_replacing_takes_any_object_and_does_not_validate(hera):
    thing = object()
    assert replace_numbers(hera, {"rotor.electric.y_m": thing}).rotor[1].y_m is thing
    assert replace_numbers(hera, {"blade.main.r.4": -7}).blade[0].r[4] == -7
    assert numbers(replace_numbers(hera, {"flight.mach": 1}))["flight.mach"] == 1  # an int is still a number's value


@pytest.mark.parametrize(
    ("path", "near"),
    [
        ("rotor.electrik.y_m", "rotor.electric.y_m"),
        ("htail.scal", "htail.scale"),
        ("blade.main.twist_deg.10", "blade.main.twist_deg"),
        ("rotor.hybrid.blades", "rotor"),
    ],
)
def test_unknown_path_names_the_nearest(hera, path, near):
    with pytest.raises(KeyError, match=near):
        replace_numbers(hera, {path: 1.0})


@pytest.mark.parametrize("change", [-1, 1])
def test_wrong_number_of_values_is_refused(hera, change):
    count = len(numbers(hera))
    with pytest.raises(ValueError, match=f"{count + change} values for {count} numbers"):
        fill(hera, [0.0] * (count + change))


def test_numbers_may_be_traced(hera):
    def area(structure, values):
        aircraft = fill(structure, list(values))
        assert isinstance(aircraft.wing.section[1].y_m, jax.core.Tracer)
        assert isinstance(aircraft.blade[0].c[2], jax.core.Tracer)
        aircraft = replace_numbers(aircraft, {"reference.S_m2": reference_S(aircraft) * 2.0})
        return reference_S(aircraft)

    compiled = jax.jit(area, static_argnums=0)
    values = jnp.array(list(numbers(hera).values()))
    assert compiled(blank(hera), values) == pytest.approx(140.0)
    slope = jax.jit(jax.grad(area, argnums=1), static_argnums=0)(blank(hera), values)
    at = list(numbers(hera)).index("reference.S_m2")
    assert slope[at] == 2.0 and jnp.count_nonzero(slope) == 1
    other = replace_numbers(hera, {"reference.S_m2": 80.0})
    assert compiled(blank(other), jnp.array(list(numbers(other).values()))) == pytest.approx(160.0)
    assert compiled._cache_size() == 1  # the structure is the same: nothing is traced again


def test_fill_takes_a_few_milliseconds(hera):
    empty, values = blank(hera), list(numbers(hera).values())
    best = float("inf")
    for _ in range(5):
        start = time.perf_counter()
        fill(empty, values)
        best = min(best, time.perf_counter() - start)
    assert best < 0.01


@pytest.mark.parametrize(
    ("path", "unit"),
    [
        ("wing.section.kink.y_m", "m"),
        ("wing.section.tip.twist_deg", "deg"),
        ("blade.main.twist_deg.3", "deg"),
        ("htail.scale", None),
        ("wing.structure.A_cap_root_m2", "m**2"),
        ("mass.battery.m_kg", "kg"),
        ("rotor.hybrid.thrust_design_N", "N"),
        ("rotor.hybrid.shaft_power_max_W", "W"),
        ("rotor.hybrid.rpm", "rpm"),
        ("material.Al7075-T6.E_Pa", "Pa"),
        ("flight.density_kg_m3", "kg/m**3"),
        ("htail.mass_per_area_kg_m2", "kg/m**2"),
        ("mission.c_s_1_per_s", "1/s"),
        ("mission.V_C_EAS_m_s", "m/s"),
        ("blade.main.polar.cl_alpha_per_rad", "1/rad"),
        ("flight.q_hat", None),
    ],
)
def test_unit_by_suffix(path, unit):
    assert unit_of(path) == unit


def test_every_unit_is_known_to_openmdao(hera):
    assert all(unit is None or valid_units(unit) for unit in map(unit_of, numbers(hera)))


def test_variable_box(hera):
    box = variable_box(hera)
    assert box.names == ("y_kink", "theta_tip", "y_prop", "htail_scale", "A_cap_root", "A_stringer_root")
    assert box.baseline == (5.6, -3.0, 8.0, 1.0, 3.0e-3, 3.5e-4)
    assert box.lower == (3.6, -5.0, 7.44, 0.8, 1.0e-3, 1.0e-4)
    assert box.upper == (8.0, 1.0, 10.24, 1.25, 5.0e-3, 6.0e-4)
    assert box.units == ("m", "deg", "m", None, "m**2", "m**2")
    assert box.ref == (8.0, 5.0, 10.24, 1.25, 5.0e-3, 6.0e-4)
    assert variable_box(load_aircraft("wing_alone")).names == ()


def test_own_reference_of_a_variable_is_kept(hera):
    text = dumps(hera).replace("upper = 10.24", "upper = 10.24\nref = 2.0")
    assert variable_box(loads(text)).ref[2] == 2.0
