"""One flight condition: what is returned, in which units, about which point."""

import numpy as np
import pytest

from hera_om.aircraft import definition_hash
from hera_om.core.errors import AnalysisFailure
from hera_om.core.registry import quantity
from hera_om.studies import analyze


@pytest.fixture(scope="module")
def found(small):
    return analyze(small)


def test_names_and_units_are_the_registry_s(found, small):
    assert found["aircraft"] == "hera_like" and found["hash"] == definition_hash(small)
    for name in ("CL", "CD", "CDi", "Cm", "L_over_D", "cl_span", "thrust", "power", "static_margin", "omega_sp"):
        assert name in found
    for c in ("CL", "CD", "CX", "CZ", "Cm"):
        for by in ("alpha", "q", "alphadot", "delta_e", "theta_hybrid", "theta_electric"):
            assert isinstance(found[f"{c}_{by}"], float)
    units = found["units"]
    assert units["alpha"] == "deg" and units["CL_alpha"] == "1/rad" and units["thrust"] == "N"
    for name, unit in units.items():
        try:
            assert unit == quantity(name).units
        except KeyError:
            assert name not in ("CL", "CD", "Cm")
    assert "CL" not in units and len(found["cl_span"]) == 8
    assert found["alpha"] == small.flight.alpha_deg


def test_moments_are_about_the_reference_point_if_there_is_one(found, small_aircraft):
    """Cm about another point: Cm' = Cm + CZ (x' - x) / c, at the same z; the masses keep their own centre."""
    moved = analyze(small_aircraft(reference__x_m=11.0, reference__y_m=0.0, reference__z_m=found["z_cg"]))
    assert moved["x_cg"] == 11.0
    shift = (11.0 - found["x_cg"]) / 2.4755
    assert moved["Cm"] == pytest.approx(found["Cm"] + found["CZ"] * shift, abs=1e-9)
    assert moved["mass"] == found["mass"]
    assert moved["x_np"] == pytest.approx(found["x_np"], abs=5e-3)  # drag areas act at the x of the moment point
    assert "static_margin" not in moved and "omega_sp" not in moved  # they are about the centre of gravity


def test_moments_are_about_the_centre_of_gravity_else(found, small):
    total = sum(m.m_kg for m in small.mass) - small.mission.climb_fuel_kg
    x = sum(m.m_kg * m.x_m for m in small.mass)
    x -= small.mission.climb_fuel_kg * next(m.x_m for m in small.mass if m.tracks == "fuel")
    assert found["x_cg"] == pytest.approx(x / total, rel=1e-12)


def test_moments_are_about_the_quarter_chord_without_masses(small_aircraft):
    """A rectangular wing of chord 2.5 m with its leading edge at x = 0."""
    found = analyze(small_aircraft("wing_rotor"))
    assert found["x_cg"] == pytest.approx(0.625, rel=1e-12)
    neutral = found["x_cg"] - 2.5 * found["Cm_alpha"] / found["CZ_alpha"]
    assert found["x_np"] == pytest.approx(neutral, rel=1e-12)
    assert "static_margin" not in found and "mass" not in found


def test_a_rotor_alone_has_no_lift_but_thrust(small_aircraft):
    found = analyze(small_aircraft("rotor_alone"))
    assert found["thrust"] > 0 and "cl_span" not in found and "x_np" not in found


def test_a_failure_is_ours(small, monkeypatch):
    monkeypatch.setattr("hera_om.components.aero.UNCONVERGED", 0.0)
    with pytest.raises(AnalysisFailure, match=r"analyze: .*aero: lattice and rotors have not converged"):
        analyze(small.model_copy(update={"flight": small.flight.model_copy(update={"alpha_deg": np.pi})}))
