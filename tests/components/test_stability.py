"""Stability component: the 747 of Etkin and Reid, Lanchester's phugoid, reference quantities."""

import tomllib

import numpy as np
import pytest

from hera_om.aircraft import load_aircraft, loads
from hera_om.components.stability import Stability

GRAVITY = 9.80665


def definition(S, c):
    return loads(f'name = "size"\n[reference]\nS_m2 = {S}\nc_m = {c}\n[flight]\nmach = 0.8')


def outputs(ready, aircraft, **values):
    problem, _ = ready(Stability(aircraft=aircraft), **values)
    return {name: float(problem.get_val(name)[0]) for name in problem.model.c._var_rel_names["output"]}


@pytest.fixture(scope="module")
def boeing(reference):
    """The 747 in registry form, axes along the flight path; its speed derivatives have no place here."""
    data = tomllib.loads((reference / "fd_b747_etkin_long.toml").read_text())["data"]
    values = {
        "CL": data["CL0"], "CD": data["CD0"], "CX_alpha": -data["Cxa"], "CZ_alpha": -data["Cza"],
        "Cm_alpha": data["Cma"], "CX_q": 0.0, "CZ_q": -data["Czq"], "Cm_q": data["Cmq"],
        "CZ_alphadot": -data["Czadot"], "Cm_alphadot": data["Cmadot"], "alpha": 0.0, "x_cg": 30.0,
        "speed": data["U0"], "density": data["rho"], "mass_cruise": data["W_N"] / data["g"],
        "Iyy": data["Iyy"],
    }  # fmt: skip
    return definition(data["S_m2"], data["c_m"]), values, data


def test_boeing(ready, boeing):
    aircraft, values, data = boeing
    out = outputs(ready, aircraft, **values)
    # Eq. 4: 0.963 rad/s; published short period -0.3719 +- 0.8875i
    assert out["omega_sp"] == pytest.approx(0.963, abs=1e-3)
    assert out["zeta_sp"] == pytest.approx(0.3865, rel=0.02)
    assert out["omega_sp_full"] == pytest.approx(0.9623, rel=5e-3)
    assert out["zeta_sp_full"] == pytest.approx(0.3865, rel=5e-3)
    # Eq. 5 and Lanchester's 107 s
    assert out["zeta_ph"] == pytest.approx(0.043 / (np.sqrt(2.0) * 0.654))
    assert 2.0 * np.pi / out["omega_ph"] == pytest.approx(107.0, rel=5e-3)
    margin = 1.023 / 4.920
    assert out["static_margin"] == pytest.approx(margin)
    assert out["x_np"] == pytest.approx(30.0 + margin * data["c_m"])
    assert out["CAP"] == pytest.approx(0.963**2 / (4.920 / 0.654), rel=3e-3)


def test_full_phugoid_tends_to_lanchesters(ready):
    # An angle of attack held by a huge Cm_alpha leaves speed and height: constant thrust gives Eq. 5 and
    # omega = sqrt(2) g / V; constant power would give 3/2 of the damping.
    speed, density, S, CL, CD = 120.0, 0.9, 50.0, 0.6, 0.04
    stiff = {"Cm_alpha": -1e5, "Cm_q": -100.0, "CX_q": 0.0, "CZ_q": 0.0, "CX_alpha": 0.0}
    mass = 0.5 * density * speed**2 * S * CL / GRAVITY
    flight = {"speed": speed, "density": density, "mass_cruise": mass, "Iyy": 3e5, "alpha": 0.0}
    out = outputs(ready, definition(S, 2.0), CL=CL, CD=CD, **stiff, **flight)
    assert out["omega_ph_full"] == pytest.approx(np.sqrt(2.0) * GRAVITY / speed, rel=1e-3)
    assert out["zeta_ph_full"] == pytest.approx(CD / (np.sqrt(2.0) * CL), rel=5e-3)
    assert out["omega_ph"] == pytest.approx(np.sqrt(2.0) * GRAVITY / speed)


def test_planform_gives_the_reference_that_is_not_given(ready):
    hera = load_aircraft("hera_like")
    free = hera.model_copy(update={"reference": hera.reference.model_copy(update={"S_m2": None, "c_m": None})})
    given, derived = outputs(ready, hera), outputs(ready, free)
    assert derived["omega_sp"] == pytest.approx(given["omega_sp"], rel=1e-3)  # the file rounds S and c
    assert "y_kink" not in ready(Stability(aircraft=hera))[1]
    moved = outputs(ready, free, y_kink=7.0)
    # S = 2 (2.77 y_kink + 2.19 (14.5 - y_kink)); x_np = x_cg + SM c
    assert moved["omega_sp"] > derived["omega_sp"]


def test_partials(ready, check_partials, boeing):
    aircraft, values, _ = boeing
    component = Stability(aircraft=aircraft)
    _, inputs = ready(component, **values | {"alpha": 2.0, "CX_q": 0.3})
    check_partials(component, inputs)


def test_missing_reference_is_named():
    with pytest.raises(ValueError, match=r"'rotor_alone' has no stability: there is no wing, and no reference.S"):
        Stability(aircraft=load_aircraft("rotor_alone"))
