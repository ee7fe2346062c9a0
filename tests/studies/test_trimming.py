"""Trim as a study: both methods, what is returned, saturation, records, bad requests."""

import pytest

from hera_om.aircraft import load_aircraft
from hera_om.core.errors import AnalysisFailure, RecordError
from hera_om.post.database import read
from hera_om.studies import trim

STATES = {"alpha", "delta_e", "theta_hybrid", "theta_electric"}


@pytest.mark.parametrize("method", ["solve", "SLSQP"])
def test_both_methods_say_the_same_things(small, method, tmp_path):
    calls = []
    database = tmp_path / "trim.db"
    found = trim(small, method=method, database=database, progress=lambda *row: calls.append(row))
    assert found["trimmed"] is True and found["method"] == method
    assert set(found["bounds"]) == STATES and all(abs(v) < 1e-6 for v in found["residuals"].values())
    # the best L/D has all thrust that it can at the hybrid rotors
    assert found["saturated"] == ([] if method == "solve" else ["theta_electric"])
    for state, (low, high) in found["bounds"].items():
        assert low < found["values"][state] < high or state in found["saturated"]
    assert found["units"]["alpha"] == "deg" and found["values"]["L_over_D"] > 10
    run = read(database)
    assert run.kind == "trim"
    assert (method == "solve") or calls


def test_balances_are_closed_to_rounding(small):
    found = trim(small)
    assert max(map(abs, found["residuals"].values())) < 1e-10
    steep = trim(small, load_factor=2)
    assert steep["trimmed"] is True and steep["values"]["CL"] > 1.8 * found["values"]["CL"]


def test_a_saturated_elevator_is_named_and_nothing_behind_it_is_given(small_aircraft):
    found = trim(small_aircraft(htail__control__elevator__limit_deg=1.0))
    assert found["trimmed"] is False
    assert found["saturated"] == ["delta_e at 1 deg"]
    assert abs(found["residuals"]["delta_e"]) > 1e-4
    assert "static_margin" not in found["values"] and "CL" in found["values"]


def test_a_failed_analysis_is_ours(small, monkeypatch):
    monkeypatch.setattr("hera_om.components.aero.UNCONVERGED", -1.0)
    for method in ("solve", "SLSQP"):
        with pytest.raises(AnalysisFailure, match="have not converged"):
            trim(small, method=method)


def test_requests_that_cannot_be_met(small, tmp_path):
    with pytest.raises(ValueError, match="method 'luck': expected 'solve' or 'SLSQP'"):
        trim(small, method="luck")
    for method in ("solve", "SLSQP"):
        with pytest.raises(ValueError, match=r"wing_tail.*mass"):
            trim(load_aircraft("wing_tail"), method=method)
    with pytest.raises(RecordError, match="nowhere"):
        trim(small, aero=tmp_path / "nowhere.npz")
