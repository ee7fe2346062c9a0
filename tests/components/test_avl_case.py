"""AVL's own input file through the whole chain: definition, component, every coefficient and derivative it prints.

``avl_rows`` gives (case, quantity, reference, ours, tolerance, source) as the tests of the lattice do.
"""

import csv

import numpy as np
import openmdao.api as om
import pytest

from hera_om.aircraft import read_avl
from hera_om.components.aero import Aerodynamics

RAD = np.pi / 180
UNIT = {"delta_e": "elevator", "delta_a": "aileron", "delta_r": "rudder"}
DIGITS = 2e-4  # relative: the table has six digits, some of small numbers
NAMES, RATES = ("CL", "Cm", "CY", "Cl", "Cn"), ("alphadot", "betadot")
SMALL = 2e-7  # half a unit of the last digit of control derivatives per degree, four times


def build(reference):
    """The ATR-like wing, tail and fin of the file, in both halves."""
    with pytest.warns(UserWarning, match="rudder"):
        aircraft = read_avl(reference / "atr_like" / "wing_tail.avl")
    built = om.Problem(reports=False)
    built.model.add_subsystem("aero", Aerodynamics(aircraft=aircraft, lateral=True), promotes=["*"])
    built.setup()
    return built


@pytest.fixture(scope="module")
def problem(reference):
    return build(reference)


def ours(problem, mach, alpha):
    """Our numbers by AVL's names: primes are stability axes, control derivatives per degree, its sign of the rudder."""
    problem.set_val("mach", mach)
    problem.set_val("alpha", alpha, units="deg")
    problem.run_model()
    c, s = np.cos(alpha * RAD), np.sin(alpha * RAD)

    def value(name):
        return float(problem.get_val(name)[0])

    def roll(by):
        return value(f"Cl_{by}") * c + value(f"Cn_{by}") * s

    def yaw(by):
        return value(f"Cn_{by}") * c - value(f"Cl_{by}") * s

    out = {"CL": value("CL"), "CDi_near": value("CDi_near"), "CDi_trefftz": value("CDi"), "Cm": value("Cm")}
    out |= {"dCL/dalpha": value("CL_alpha"), "dCm/dalpha": value("Cm_alpha")}
    out |= {"dCL/dq'": value("CL_q"), "dCm/dq'": value("Cm_q"), "dCY/dbeta": value("CY_beta")}
    out |= {"dCl'/dbeta": roll("beta"), "dCn'/dbeta": yaw("beta")}
    out |= {"dCl'/dp'": roll("p") * c + roll("r") * s, "dCn'/dp'": yaw("p") * c + yaw("r") * s}
    out |= {"dCl'/dr'": roll("r") * c - roll("p") * s, "dCn'/dr'": yaw("r") * c - yaw("p") * s}
    out["neutral point"] = 0.770764 - 2.302150 * value("Cm_alpha") / value("CL_alpha")
    out |= {"dCL/delevator": value("CL_delta_e") * RAD, "dCm/delevator": value("Cm_delta_e") * RAD}
    out |= {"dCl'/daileron": roll("delta_a") * RAD, "dCn'/daileron": yaw("delta_a") * RAD}
    return out | {"dCY/drudder": -value("CY_delta_r") * RAD, "dCn'/drudder": -yaw("delta_r") * RAD}


def avl_rows(reference, problem):
    """Every quantity of the rows on AVL's own lattice."""
    with (reference / "atr_like" / "avl_wing_tail.csv").open() as lines:
        table = [r for r in csv.DictReader(x for x in lines if not x.startswith("#")) if r["tag"].startswith("base")]
    out = []
    for row in table:
        found = ours(problem, float(row["mach"]), float(row["alpha"]))
        case = f"wing_tail.avl, alpha {row['alpha']}, Mach {row['mach']}"
        out += [(case, k, float(row[k]), v, DIGITS, "AVL through OptVL 2.5.0") for k, v in found.items()]
    return out


def test_every_number_of_avl(reference, problem):
    """CL, both drags, Cm, all longitudinal, lateral and control derivatives, at two incidences and two Mach numbers."""
    rows = avl_rows(reference, problem)
    assert len(rows) == 3 * 22
    for case, quantity, expected, value, tolerance, _ in rows:
        per_degree = quantity.endswith(tuple(UNIT.values()))
        absolute = SMALL if per_degree else 1.5e-6
        assert value == pytest.approx(expected, rel=tolerance, abs=absolute), (case, quantity)


def test_each_deflection_changes_the_loads(problem):
    """Elevator, aileron and rudder move the coefficients that their derivatives say, to first order."""
    problem.set_val("mach", 0.0)
    problem.set_val("alpha", 2.0, units="deg")
    for command, name in (("delta_e", "Cm"), ("delta_a", "Cl"), ("delta_r", "Cn")):
        problem.set_val(command, 0.0)
        problem.run_model()
        before, slope = float(problem.get_val(name)[0]), float(problem.get_val(f"{name}_{command}")[0])
        problem.set_val(command, 1.0, units="deg")
        problem.run_model()
        assert float(problem.get_val(name)[0]) - before == pytest.approx(slope * RAD, rel=0.01) and abs(slope) > 0.05
        problem.set_val(command, 0.0)


def test_rates_of_incidence_and_sideslip(problem):
    """The first moves lift and pitch, the second side force, roll and yaw.

    Most of the side force is the fin's and acts behind its aerodynamic centre: between a quarter and three quarters
    of its mean chord of 3.34 m, 12.98 to 14.65 m behind the point.
    """
    problem.run_model()
    by = {f"{name}_{rate}": float(problem.get_val(f"{name}_{rate}")[0]) for name in NAMES for rate in RATES}
    for name in NAMES:
        still = RATES[name in ("CL", "Cm")]
        assert by[f"{name}_{still}"] == 0.0 and by[f"{name}_{RATES[still == RATES[0]]}"] != 0.0
    assert by["Cm_alphadot"] < -1.0
    assert by["CY_betadot"] < 0.0 and 12.98 < -27.05 * by["Cn_betadot"] / by["CY_betadot"] < 14.65
