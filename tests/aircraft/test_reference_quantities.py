"""Reference quantities and places of sections against closed forms and the reference cases."""

import math

import jax
import jax.numpy as jnp
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hera_om.aircraft import load_aircraft, loads, reference_b, reference_c, reference_S, replace_numbers
from hera_om.aircraft.reference import wing_area, wing_mac, wing_quarter_mac, wing_sections, wing_span


def wing(span, root, tip, sweep=0.0, dihedral=0.0):
    return loads(f"""
name = "w"
flight = {{ mach = 0.0 }}
[[wing.section]]
name = "root"
y_m = 0.0
chord_m = {root!r}
thickness = 0.1
airfoil = "flat"
[[wing.section]]
name = "tip"
y_m = {span / 2!r}
chord_m = {tip!r}
thickness = 0.1
airfoil = "flat"
sweep_quarter_deg = {sweep!r}
dihedral_deg = {dihedral!r}
""")


@given(
    st.floats(1.0, 50.0),
    st.floats(0.2, 5.0),
    st.floats(0.2, 1.0),
    st.floats(-40.0, 40.0),
    st.floats(-20.0, 20.0),
)
def test_trapezoid_has_the_textbook_values(span, root, taper, sweep, dihedral):
    aircraft = wing(span, root, root * taper, sweep, dihedral)
    y_mac = span / 6.0 * (1.0 + 2.0 * taper) / (1.0 + taper)
    assert reference_b(aircraft) == pytest.approx(span)
    assert reference_S(aircraft) == pytest.approx(span * root * (1.0 + taper) / 2.0)
    assert reference_c(aircraft) == pytest.approx(2.0 / 3.0 * root * (1.0 + taper + taper**2) / (1.0 + taper))
    place = wing_quarter_mac(aircraft.wing)
    assert place.x == pytest.approx(0.25 * root + y_mac * math.tan(math.radians(sweep)), abs=1e-9)
    assert place.z == pytest.approx(y_mac * math.tan(math.radians(dihedral)), abs=1e-9)


def test_atr_like_wing_has_the_values_of_its_source():
    aircraft = load_aircraft("wing_tail")
    assert wing_area(aircraft.wing) == pytest.approx(61.0, rel=5e-6)  # six decimals in the source
    assert wing_mac(aircraft.wing) == pytest.approx(2.302150, rel=5e-6)
    assert wing_quarter_mac(aircraft.wing).x == pytest.approx(0.770764, abs=1e-5)
    assert wing_span(aircraft.wing) == 27.05


def test_sweep_and_absolute_places_describe_the_same_wing():
    absolute = load_aircraft("wing_tail")
    chord = 0.25 * (2.572822 - 1.595150)
    dy = 13.525 - 4.73375
    by_angles = wing_sections(
        replace_numbers(
            wing(27.05, 2.572822, 1.595150, math.degrees(math.atan((0.705161 - chord) / dy)), 2.5),
            {"wing.section.root.y_m": 4.73375},
        ).wing
    )
    assert by_angles[1].x == pytest.approx(wing_sections(absolute.wing)[-1].x, abs=1e-9)
    assert by_angles[1].z == pytest.approx(wing_sections(absolute.wing)[-1].z, abs=2e-6)
    assert math.degrees(math.atan((0.705161 - chord) / dy)) == pytest.approx(3.0, abs=1e-4)


def test_given_values_win():
    aircraft = load_aircraft("hera_like")
    assert (reference_S(aircraft), reference_c(aircraft), reference_b(aircraft)) == (70.0, 2.4755, 29.0)
    assert wing_area(aircraft.wing) == pytest.approx(70.006)
    assert wing_mac(aircraft.wing) == pytest.approx(2.4755, abs=5e-5)


@pytest.mark.parametrize("function", [reference_S, reference_c, reference_b])
def test_neither_given_nor_derived_is_said(function):
    with pytest.raises(ValueError, match="nor a wing"):
        function(load_aircraft("rotor_alone"))


def test_derivatives_by_the_kink_are_exact():
    aircraft = load_aircraft("hera_like")

    def measures(y, tan=jnp.tan):
        w = replace_numbers(aircraft, {"wing.section.kink.y_m": y}).wing
        return jnp.stack([wing_area(w), wing_mac(w), wing_quarter_mac(w, tan).x, wing_quarter_mac(w, tan).z])

    slope = jax.jacfwd(measures)(5.6)
    step = 1e-4
    central = (measures(5.6 + step) - measures(5.6 - step)) / (2.0 * step)
    assert jnp.max(jnp.abs(slope - central)) < 1e-8 * jnp.max(jnp.abs(slope))
    assert slope[0] == pytest.approx(2.77 - 1.61)  # S = (c_r + c_k) y + (c_k + c_t) (b/2 - y), by hand
    second = jax.jacfwd(jax.jacfwd(measures))(5.6)
    assert second[0] == pytest.approx(0.0, abs=1e-12)
    assert jnp.all(jnp.isfinite(second))
