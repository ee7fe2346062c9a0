"""The record of a run: what is written, what survives a kill, what is refused."""

import json
import math
import os
import signal
import sqlite3
import subprocess
import sys
from itertools import pairwise

import numpy as np
import openmdao
import openmdao.api as om
import pytest

from hera_om.aircraft import definition_hash, load_aircraft, loads
from hera_om.core.errors import AnalysisFailure, RecordError
from hera_om.post.database import read
from hera_om.studies import record as module
from hera_om.studies.record import FORMAT, Record, worst_violation

VARIABLES = [
    {"name": "y_kink", "path": "a.b", "units": "m", "lower": 1.0, "baseline": 3.0, "upper": 8.0},
    {"name": "theta_tip", "path": "a.b", "units": "deg", "lower": -5.0, "baseline": 2.0, "upper": 5.0},
]  # fmt: skip
CONSTRAINTS = [{"name": "static_margin", "units": None, "lower": 0.5, "upper": None, "reason": "test"}]
OBJECTIVE = {"name": "range_fixed_mass", "units": "km", "sense": "max"}


@pytest.fixture(scope="module")
def aircraft():
    return load_aircraft("wing_alone")


def keys(path):
    """Our key table, decoded."""
    connection = sqlite3.connect(path)
    found = {k: json.loads(v) for k, v in connection.execute("SELECT key, value FROM hera_om")}
    connection.close()
    return found


class Bowl(om.ExplicitComponent):
    """A bowl with a registry constraint, an array that is not to be recorded, an analysis that can fail."""

    def initialize(self):
        self.options.declare("fail_from", default=10**9)
        self.calls = 0

    def setup(self):
        self.add_input("y_kink", 3.0, units="m")
        self.add_input("theta_tip", 2.0, units="deg")
        self.add_output("range_fixed_mass", units="m")
        self.add_output("static_margin")
        self.add_output("private", desc="not in the registry")
        self.add_output("cl_span", shape=5)
        self.declare_partials("*", "*", method="fd")

    def compute(self, inputs, outputs):
        self.calls += 1
        if self.calls > self.options["fail_from"] and not self.under_approx:
            raise om.AnalysisError("the trim has no solution")
        y, t = inputs["y_kink"], inputs["theta_tip"]
        outputs["range_fixed_mass"] = 1e6 - 1000.0 * ((y - 5.0) ** 2 + t**2)
        outputs["static_margin"] = 0.1 * y + 0.1 * t
        outputs["private"], outputs["cl_span"] = y, np.ones(5)


def bowl(name, **options):
    """The bowl as a problem for SLSQP."""
    problem = om.Problem(name=name, reports=False)
    problem.model.add_subsystem("bowl", Bowl(**options), promotes=["*"])
    for v in VARIABLES:
        problem.model.add_design_var(v["name"], lower=v["lower"], upper=v["upper"], units=v["units"])
    problem.model.add_objective("range_fixed_mass", units="km", ref=-1000.0)
    problem.model.add_constraint("static_margin", lower=0.5)
    problem.driver = om.ScipyOptimizeDriver(optimizer="SLSQP", tol=1e-8, disp=False)
    problem.setup()
    return problem


def record(path, aircraft, **more):
    """A record of the bowl."""
    given = {"kind": "mdo", "variables": VARIABLES, "constraints": CONSTRAINTS, "objective": OBJECTIVE}
    return Record(path, aircraft=aircraft, **(given | more))


@pytest.fixture(scope="module")
def finished(tmp_path_factory, aircraft):
    """A finished run of the bowl: its database and the rows that the progress callback saw."""
    path, seen = tmp_path_factory.mktemp("record") / "mdo.db", []
    problem = bowl("record_finished")
    with record(path, aircraft, options={"driver": "SLSQP"}) as r:
        r.attach(problem, progress=seen.append)
        problem.run_driver()
        problem.record("optimum")
        values = {"CL": np.float64(0.5), "CD": math.nan}
        r.snapshot("optimum", {"values": values, "arrays": {"y": np.arange(3.0)}})
        r.result({"success": True})
    return path, seen


def test_the_head_says_what_ran(finished, aircraft):
    head = keys(finished[0])
    assert head["format"] == FORMAT and head["kind"] == "mdo"
    assert head["definition_hash"] == definition_hash(aircraft)
    assert loads(head["definition"]) == aircraft
    assert head["provenance"]["openmdao"] == openmdao.__version__
    assert head["options"] == {"driver": "SLSQP"}
    assert head["variables"] == VARIABLES and head["constraints"] == CONSTRAINTS and head["objective"] == OBJECTIVE
    assert head["started"] <= head["finished"]


def test_each_evaluation_is_a_row_and_a_driver_case(finished):
    path, seen = finished
    run, cases = read(path), om.CaseReader(str(path))
    names = cases.list_cases("driver", out_stream=None)
    assert [r["iteration"] for r in run.history] == list(range(1, len(names) + 1))
    assert len(names) > 3
    for row, name in zip(run.history, names, strict=True):
        case = cases.get_case(name)
        assert row["variables"]["y_kink"] == float(case.get_val("y_kink")[0])
        assert row["objective"] == pytest.approx(float(case.get_val("range_fixed_mass", units="km")[0]), rel=1e-14)
        assert row["constraints"]["static_margin"] == float(case.get_val("static_margin")[0])
    assert [r["iteration"] for r in seen] == [r["iteration"] for r in run.history]
    assert all(a["time_s"] <= b["time_s"] for a, b in pairwise(seen))


def test_the_history_ends_at_the_known_optimum(finished):
    last = read(finished[0]).history[-1]
    assert last["variables"]["y_kink"] == pytest.approx(5.0, abs=1e-4)
    assert last["variables"]["theta_tip"] == pytest.approx(0.0, abs=1e-4)
    assert last["objective"] == pytest.approx(1000.0, rel=1e-7)  # km, though the model has m
    assert last["worst_violation"] < 1e-6


def test_registry_scalars_are_recorded_and_no_array(finished):
    outputs = read(finished[0]).history[0]["outputs"]
    assert set(outputs) == {"range_fixed_mass", "static_margin"}
    cases = om.CaseReader(str(finished[0]))
    assert "cl_span" not in cases.get_case(0).outputs and "private" not in cases.get_case(0).outputs
    assert cases.list_cases("problem", out_stream=None) == ["optimum"]


def test_numpy_becomes_json_and_nan_becomes_null(finished):
    shot = keys(finished[0])["snapshot:optimum"]
    assert shot == {"values": {"CL": 0.5, "CD": None}, "arrays": {"y": [0.0, 1.0, 2.0]}}


def test_variables_default_to_those_of_the_definition(tmp_path):
    with Record(tmp_path / "a.db", kind="analyze", aircraft=load_aircraft("hera_like")) as r:
        names = [v["name"] for v in r.variables]
    assert names == ["y_kink", "theta_tip", "y_prop", "htail_scale", "A_cap_root", "A_stringer_root"]
    assert r.variables[0] == {
        "name": "y_kink", "path": "wing.section.kink.y_m", "units": "m",
        "lower": 3.6, "baseline": 5.6, "upper": 8.0,
    }  # fmt: skip


def test_unknown_kind_is_refused_before_any_file_is_made(tmp_path, aircraft):
    with pytest.raises(ValueError, match="kind 'doe' is none of mdo, trim, analyze"):
        record(tmp_path / "a.db", aircraft, kind="doe")
    assert not any(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("value", "expected"),
    [(0.5, 0.0), (2.0, 0.0), (1.6, 0.0), (0.3, 0.4), (2.5, 0.25), (-1.5, 4.0)],
)
def test_worst_violation_is_relative_to_the_bound(value, expected):
    both = [{"name": "a", "lower": 0.5, "upper": 2.0}]
    assert worst_violation(both, {"a": value}) == pytest.approx(expected, abs=1e-15)


def test_worst_violation_of_a_bound_of_zero_is_absolute():
    equal = [{"name": "a", "lower": 0.0, "upper": 0.0}, {"name": "b", "lower": None, "upper": None}]
    assert worst_violation(equal, {"a": -0.3, "b": 7.0}) == 0.3


def test_a_failed_analysis_is_recorded_as_such_without_stale_numbers(tmp_path, aircraft):
    path, problem = tmp_path / "mdo.db", bowl("record_failing", fail_from=1)
    with pytest.raises(om.AnalysisError), record(path, aircraft) as r:
        r.attach(problem)
        problem.run_driver()
    run = read(path)
    assert run.status == "failed" and "no solution" in run.failure["message"]
    failed = run.history[-1]
    assert failed["success"] is False
    assert failed["objective"] is None and failed["outputs"] == {} and failed["constraints"] == {}
    case = om.CaseReader(str(path)).get_case(-1)
    assert case.success == 0 and "no solution" in case.msg


def test_an_error_of_ours_keeps_its_parts(tmp_path, aircraft):
    with pytest.raises(AnalysisFailure), record(tmp_path / "a.db", aircraft):
        raise AnalysisFailure("saturated", where="elevator")
    failure = read(tmp_path / "a.db").failure
    assert failure == {
        "kind": "analysis",
        "what": "saturated",
        "where": "elevator",
        "hint": "",
        "message": "elevator: saturated",
    }


def test_after_closing_the_problem_still_runs_and_the_record_refuses(tmp_path, aircraft):
    problem = bowl("record_closed")
    with record(tmp_path / "a.db", aircraft) as r:
        r.attach(problem)
        problem.run_driver()
    count = len(read(tmp_path / "a.db").history)
    problem.run_driver()
    assert len(read(tmp_path / "a.db").history) == count
    with pytest.raises(RecordError, match=r"a\.db: the record is closed"):
        r.note("a", 1)


def test_an_older_record_is_kept_as_a_backup(tmp_path, aircraft):
    path = tmp_path / "a.db"
    for mark in ("first", "second"):
        with record(path, aircraft) as r:
            r.note("mark", mark)
    assert keys(path)["mark"] == "second"
    assert keys(tmp_path / "a.db.bak")["mark"] == "first"


@pytest.mark.parametrize("make", ["text", "sqlite", "folder"])
def test_a_foreign_file_is_refused_and_left_alone(tmp_path, aircraft, make):
    path = tmp_path / "thesis.db"
    if make == "folder":
        path.mkdir()
    elif make == "text":
        path.write_text("my only copy " * 100)
    else:
        connection = sqlite3.connect(path)
        connection.execute("CREATE TABLE mine (a)")
        connection.close()
    before = None if make == "folder" else path.read_bytes()
    with pytest.raises(RecordError, match=r"thesis\.db: .*not a database of hera_om; it is not overwritten"):
        record(path, aircraft)
    assert path.is_dir() if make == "folder" else path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


def test_an_empty_file_is_taken(tmp_path, aircraft):
    (tmp_path / "a.db").touch()
    with record(tmp_path / "a.db", aircraft):
        pass
    assert read(tmp_path / "a.db").kind == "mdo"


def test_no_folder(tmp_path, aircraft):
    with pytest.raises(RecordError, match=r"there is no folder .*nowhere"):
        record(tmp_path / "nowhere" / "a.db", aircraft)


@pytest.mark.skipif(not os.path.isdir("/proc/self"), reason="needs a folder in which nobody may write")
def test_unwritable_folder(aircraft):
    with pytest.raises(RecordError, match=r"/proc/mdo\.db: the record cannot be written: unable to open"):
        record("/proc/mdo.db", aircraft)


def test_when_the_new_file_fails_the_older_one_is_put_back(tmp_path, aircraft, monkeypatch):
    path = tmp_path / "a.db"
    with record(path, aircraft) as r:
        r.note("mark", "first")

    def full(self):
        raise sqlite3.OperationalError("database or disk is full")

    monkeypatch.setattr(module._Cases, "create", full)
    with pytest.raises(RecordError, match=r"a\.db: the record cannot be written: database or disk is full"):
        record(path, aircraft)
    assert keys(path)["mark"] == "first"


def test_a_full_disk_names_the_file_and_costs_no_finished_row(tmp_path, aircraft):
    path = tmp_path / "a.db"
    with (
        pytest.raises(RecordError, match=r"a\.db: the record cannot be written: database or disk is full"),
        record(path, aircraft) as r,
    ):
        r._connection.execute("PRAGMA max_page_count = 60")
        for i in range(1, 10_000):
            r.history({"iteration": i, "outputs": {"CL": 0.5}, "pad": "x" * 500})
            written = i
    run = read(path)
    assert [row["iteration"] for row in run.history] == list(range(1, written + 1))


def test_a_full_disk_below_openmdao_names_the_file(tmp_path, aircraft):
    problem = bowl("record_full")
    with (
        pytest.raises(RecordError, match=r"a\.db: the record cannot be written: database or disk is full"),
        record(tmp_path / "a.db", aircraft) as r,
    ):
        r.attach(problem)
        problem.final_setup()
        (pages,) = r._cases.connection.execute("PRAGMA page_count").fetchone()
        r._cases.connection.execute(f"PRAGMA max_page_count = {pages}")
        for _ in range(100):
            problem.run_driver()


WRITER = """
import sys
from hera_om.aircraft import load_aircraft
from hera_om.studies.record import Record
with Record(sys.argv[1], kind="mdo", aircraft=load_aircraft("wing_alone")) as r:
    for i in range(1, 100000):
        r.history({"iteration": i, "objective": float(i), "outputs": {"CL": 0.5 + i}, "pad": "x" * 3000})
        print(i, flush=True)
"""


def test_a_killed_run_keeps_every_finished_evaluation(tmp_path, aircraft, root):
    path = tmp_path / "killed.db"
    environment = os.environ | {"PYTHONPATH": str(root)}
    with subprocess.Popen(
        [sys.executable, "-c", WRITER, path], stdout=subprocess.PIPE, text=True, env=environment
    ) as writer:
        for _ in range(25):
            last = int(writer.stdout.readline())
        with pytest.raises(RecordError, match=f"process {writer.pid} is writing this record"):
            record(path, aircraft)
        writer.send_signal(signal.SIGKILL)
        last = max([last, *(int(line) for line in writer.stdout.read().split())])
    run = read(path)
    assert run.status == "unfinished" and run.finished is None
    assert len(run.history) in (last, last + 1)  # the last commit may have come before its print
    assert [row["objective"] for row in run.history[:last]] == [float(i) for i in range(1, last + 1)]
    with record(path, aircraft):  # a dead writer is no reason to refuse
        pass
    assert len(read(tmp_path / "killed.db.bak").history) == len(run.history)
