import json
import math
import pickle

from hera_om.core.errors import AnalysisFailure, HeraError, InputError, Problem, RecordError


def test_report_has_one_line_for_each_problem():
    error = InputError([Problem("a.toml", "wing.x_m", "far", "a number [m]"), Problem("a.toml", "", "empty", "TOML")])
    head, first, second = str(error).splitlines()
    assert head == "2 errors in the input"
    assert first == "a.toml: wing.x_m: got 'far', expected a number [m]"
    assert second == "a.toml: empty; expected TOML"


def test_absent_value_reads_as_nothing_and_long_values_are_cut():
    assert "got nothing" in str(Problem("f", "k", None, "e"))
    assert len(str(Problem("f", "k", "x" * 1000, "e"))) < 120


def test_report_is_plain_json():
    problems = [Problem("f", "k", v, "e") for v in (math.nan, -math.inf, 1.5, True, None, {"a": 1})]
    found = json.loads(json.dumps(InputError(problems).to_json(), allow_nan=False))
    assert [p["value"] for p in found["problems"]] == ["nan", "-inf", 1.5, True, None, "{'a': 1}"]
    assert found["problems"][0].keys() == {"file", "key", "value", "expected"}


def test_every_error_is_ours_survives_pickling_and_says_where():
    failure = AnalysisFailure("no equilibrium", "elevator", "allow more deflection")
    assert str(failure) == "elevator: no equilibrium (allow more deflection)"
    assert str(AnalysisFailure("diverged")) == "diverged"
    assert failure.to_json() == {
        "kind": "analysis",
        "what": "no equilibrium",
        "where": "elevator",
        "hint": "allow more deflection",
    }
    record = RecordError("run.db: not a database")
    assert record.to_json()["message"] == "run.db: not a database"
    for error in (failure, InputError([Problem("f", "k", 1, "e")]), record):
        assert isinstance(error, HeraError)
        again = pickle.loads(pickle.dumps(error))
        assert type(again) is type(error)
        assert str(again) == str(error)
