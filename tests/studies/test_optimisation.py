"""The optimisation as a study: results, record, analyses that fail, what is said of an optimum."""

import json
import sqlite3

import numpy as np
import openmdao.api as om
import pytest

from hera_om.aircraft import variable_box
from hera_om.components.wingbox import WingBox
from hera_om.core.errors import AnalysisFailure
from hera_om.models.cases import Goal, Limit
from hera_om.models.problems import build_aircraft
from hera_om.post.database import read
from hera_om.studies import mdo
from hera_om.studies import optimisation as module
from hera_om.studies.optimum import constraint_rows, gain_by_cause, multipliers, variable_rows

KEYS = {"aircraft", "hash", "units", "baseline", "optimum", "constraints", "variables", "optimality", "feasible"}
KEYS |= {"gain", "success", "message", "iterations", "evaluations", "gradients", "seconds", "failures"}


def keys(path):
    """Our key table, decoded."""
    connection = sqlite3.connect(path)
    found = {k: json.loads(v) for k, v in connection.execute("SELECT key, value FROM hera_om")}
    connection.close()
    return found


@pytest.fixture(scope="module")
def run(small, tmp_path_factory):
    """Three iterations of SLSQP."""
    database, calls = tmp_path_factory.mktemp("mdo") / "mdo.db", []
    found = mdo(small, database=database, max_iterations=3, progress=lambda *row: calls.append(row))
    return found, database, calls


def test_result_and_record(run):
    found, database, calls = run
    assert set(found) == KEYS and found["aircraft"] == "hera_like"
    assert found["optimum"]["range_fixed_mass"] != found["baseline"]["range_fixed_mass"]
    assert set(found["constraints"]) == {"static_margin", "omega_sp", "zeta_sp", "zeta_ph", "RFC", "RFT"}
    assert found["evaluations"] >= 3 and len(calls) == len(read(database).history)
    rows = keys(database)
    assert {"snapshot:baseline", "snapshot:optimum", "result", "finished", "options"} <= set(rows)
    assert rows["result"]["optimum"]["CL"] == pytest.approx(found["optimum"]["CL"])


def test_a_result_that_violates_a_limit_is_not_feasible(run):
    """Three iterations end at the limit of iterations: what the driver hands over is judged by us."""
    found, _, _ = run
    assert found["success"] is False
    violated = [n for n, row in found["constraints"].items() if row["violated"]]
    assert found["feasible"] is (not violated)
    for name in violated:
        row = found["constraints"][name]
        assert row["value"] < (row["lower"] or -np.inf) or row["value"] > (row["upper"] or np.inf)


def test_the_baseline_is_the_analysis_of_the_definition(run, small):
    found, _, _ = run
    problem = build_aircraft(small)
    problem.run_model()
    for name in ("CL", "CD", "L_over_D", "alpha", "omega_sp", "range_fixed_mass", "RFC", "m_wing"):
        assert found["baseline"][name] == pytest.approx(problem.get_val(name).item(), rel=1e-8), name


def test_gains_by_cause_sum_to_the_gain(run):
    found, _, _ = run
    gain = dict(found["gain"])
    total = gain.pop("total")
    after, before = (found[k]["range_fixed_mass"] for k in ("optimum", "baseline"))
    assert total == pytest.approx(after - before, rel=1e-12)
    assert sum(gain.values()) == pytest.approx(total, rel=1e-9)


def test_a_gain_by_drag_alone_goes_to_drag_alone():
    parts = {"CDi_near": 0.010, "CD_slipstream": 0.0, "CD_profile": 0.015, "CD_fuselage": 0.003, "CD_areas": 0.002}
    before = parts | {"CL": 0.5, "CD": 0.030, "L_over_D": 0.5 / 0.030, "range_fixed_mass": 1000.0, "mass_saved": 0.0}
    after = before | {"CDi_near": 0.007, "CD": 0.027, "L_over_D": 0.5 / 0.027, "range_fixed_mass": 1000 * 30 / 27}
    gain = gain_by_cause(before | {"m_wing": 3300.0}, after | {"m_wing": 3300.0})
    assert gain["induced drag"] == pytest.approx(gain["total"]) == pytest.approx(1000 / 9)
    assert gain["profile drag"] == gain["lift coefficient"] == gain["fuel from wing mass"] == 0.0


def test_cobyla_runs_the_same_problem(small, tmp_path, run):
    found = mdo(small, driver="COBYLA", database=tmp_path / "c.db", max_iterations=12)
    assert set(found) == KEYS and found["gradients"] == 0 and 12 <= found["evaluations"] <= 14
    assert found["baseline"]["CL"] == pytest.approx(run[0]["baseline"]["CL"], rel=1e-9)
    assert len(read(tmp_path / "c.db").history) >= 12


def test_a_start_outside_the_choices(small, tmp_path):
    with pytest.raises(ValueError, match="start 'moon': expected one of baseline, low, high"):
        mdo(small, database=tmp_path / "m.db", start="moon", max_iterations=1)


# --- analyses that fail


def fail_where(monkeypatch, broken):
    """Make the wing box fail where ``broken`` says so of its inputs; returns the inputs that it saw."""
    seen, original = [], WingBox.compute

    def compute(self, inputs, outputs):
        seen.append(float(inputs["A_cap_root"][0]))
        if broken(seen[-1], len(seen)):
            raise om.AnalysisError("injected")
        original(self, inputs, outputs)

    monkeypatch.setattr(WingBox, "compute", compute)
    return seen


def test_a_failed_analysis_sends_the_driver_back_in_a_smaller_box(small, tmp_path, monkeypatch):
    """The cap area's lower quarter cannot be analysed; the run ends within what is left, and says so."""
    box = variable_box(small)
    i = box.names.index("A_cap_root")
    edge = box.lower[i] + 0.25 * (box.upper[i] - box.lower[i])
    seen = fail_where(monkeypatch, lambda area, _: area < edge)
    found = mdo(small, database=tmp_path / "f.db", max_iterations=4)
    assert min(seen) < edge
    assert 1 <= len(found["failures"]) < module.ATTEMPTS and "injected" in found["failures"][0]
    assert keys(tmp_path / "f.db")["failures"] == found["failures"]
    first = next(k for k, area in enumerate(seen) if area < edge)
    assert min(seen[first + 1 :]) >= 0.5 * (box.lower[i] + box.baseline[i]) - 1e-9 or len(found["failures"]) == 2
    assert found["optimum"]["A_cap_root"] >= edge
    history = read(tmp_path / "f.db").history
    assert len(history) >= 3


def test_failures_without_end_end_the_study(small, tmp_path, monkeypatch):
    """Everything but the baseline fails: an error after some attempts, with what was finished on the disk."""
    baseline = small.wing.structure.A_cap_root_m2
    fail_where(monkeypatch, lambda area, _: abs(area - baseline) > 1e-9)
    with pytest.raises(AnalysisFailure, match=f"mdo: {module.ATTEMPTS} attempts ended in failed analyses.*injected"):
        mdo(small, database=tmp_path / "f.db", max_iterations=4)
    rows = keys(tmp_path / "f.db")
    assert len(rows["failures"]) == module.ATTEMPTS
    assert "snapshot:baseline" in rows and "failure" in rows and "result" not in rows
    done = [row for row in read(tmp_path / "f.db").history if row["success"]]
    assert done and all(row["objective"] > 0 for row in done)


def test_a_baseline_that_fails_is_named(small, tmp_path, monkeypatch):
    fail_where(monkeypatch, lambda area, _: True)
    with pytest.raises(AnalysisFailure, match=r"baseline.*injected"):
        mdo(small, database=tmp_path / "f.db")


# --- what is said of an optimum


def test_multipliers_of_a_known_optimum(small):
    """Maximise 3 x + y under x <= 1 (active) and y at its upper bound: multipliers 3 and 1, nothing left."""
    problem, units = om.Problem(reports=False), {"y_kink": {"units": "m"}, "theta_tip": {"units": "deg"}}
    model = problem.model
    model.add_subsystem("f", om.ExecComp("f = 3 * y_kink + theta_tip", **units), promotes=["*"])
    model.add_subsystem("g", om.ExecComp("g = y_kink", y_kink=units["y_kink"]), promotes=["*"])
    aircraft = small.model_copy(update={"variables": small.variables[:2]})
    box = variable_box(aircraft)
    problem.setup()
    problem.set_val("y_kink", 5.0)
    problem.set_val("theta_tip", box.upper[1])
    problem.run_model()
    rows = constraint_rows(problem, (Limit("g", None, 5.0, "test"),))
    variables = variable_rows(problem, aircraft)
    assert rows["g"]["active"] and not rows["g"]["violated"] and variables["theta_tip"]["at_bound"] == "upper"
    left = multipliers(problem, aircraft, Goal("f", "max", 1.0), rows, variables)
    assert rows["g"]["multiplier"] == pytest.approx(3.0) and variables["theta_tip"]["multiplier"] == pytest.approx(1.0)
    assert left["residual"] == pytest.approx(0.0, abs=1e-9)


def test_a_point_that_is_no_optimum_leaves_a_residual(run):
    found, _, _ = run
    assert 0.0 < found["optimality"]["residual"] <= found["optimality"]["gradient"]


def test_margins_are_signed_and_relative():
    problem = om.Problem(reports=False)
    problem.model.add_subsystem("g", om.ExecComp("g = x"), promotes=["*"])
    problem.setup()
    limit = (Limit("g", 1.0, 3.0, "test"),)
    for x, margin, violated in ((2.0, 1 / 3, False), (1.1, 0.1, False), (0.9, -0.1, True), (3.3, -0.1, True)):
        problem.set_val("x", x)
        problem.run_model()
        row = constraint_rows(problem, limit)["g"]
        assert row["margin"] == pytest.approx(margin) and row["violated"] is violated
