"""The command line as a user and a script meet it: status, standard output, standard error, bad input."""

import ctypes
import json
import os
import re
import subprocess
import sys
import types
from importlib import resources
from pathlib import Path

import numpy as np
import pytest

from hera_om.cli import main
from hera_om.cli.tables import grid
from hera_om.core.errors import AnalysisFailure, InputError, Problem, RecordError

ROOT = Path(__file__).resolve().parents[1]
TEXT = (resources.files("hera_om.aircraft") / "data" / "hera_like.toml").read_text("utf-8")
COMMANDS = ("check", "analyze", "trim", "mdo", "train", "interaction", "report")
HEAVY = "jax jaxlib openmdao pandas pydantic numpy scipy smt matplotlib rich".split()
SQLITE = b"SQLite format 3\0"
ENV = {k: v for k, v in os.environ.items() if k != "PYTHONUNBUFFERED"} | {"PYTHONPATH": str(ROOT)}

POINT = {
    "alpha": 1.25,
    "mach": 0.5,
    "altitude": 6096.0,
    "theta_hybrid": 46.5,
    "CL": 0.475,
    "CD": 0.0300,
    "CDi": 0.0090,
    "CD_profile": 0.0120,
    "CL_alpha": 6.4321,
    "CL_theta_hybrid": 0.0123,
    "Cm_alpha": -1.5,
    "Cm_q": -33.0,
    "thrust_hybrid": 5600.0,
    "power_hybrid": 1.1e6,
    "omega_sp": 2.05,
    "cl_span": np.array([0.5, 0.6]),
}

PART = {c: 0.25 for c in ("CX", "CZ", "Cm", "CX_alpha", "CZ_alpha", "Cm_alpha")}
INTERACTION = {
    "aircraft": "hera_like",
    "hash": "0" * 64,
    "table2": [{"table": 2, "case": "0 deg", "ours": {"thrust change": 5.5}, "paper": {"thrust change": 11.21}}],
    "table3": [{"table": 3, "case": "Fuselage + tail", "ours": {"CZ_alpha": 0.0123}, "paper": {"CZ_alpha": 0.014139}}],
    "differences": [
        {"table": 2, "case": "0 deg", "quantity": "thrust change", "ours": 5.5, "paper": 11.21, "ratio": 0.49}
    ],
    "split": [{"alpha": 0.0, "power_on": {"wing": PART, "rotors": PART}, "slipstream": {"wing": PART}}],
}


def python(code, *words, cwd=None, **options):
    """Run the command line, after some code, in a process of its own."""
    script = f"import sys\nfrom hera_om.cli import main\n{code}\n"
    options = {"capture_output": True, "text": True, "timeout": 60} | options
    return subprocess.run([sys.executable, "-c", script, *words], cwd=cwd, env=ENV, **options)


def hera_om(*words, **options):
    return python("sys.exit(main())", *words, **options)


@pytest.fixture
def studies(monkeypatch, tmp_path):
    """A stand-in for the studies and for post; it notes the calls, and the test puts the results in."""
    calls = []
    results = {
        "analyze": {"aircraft": "hera_like", "hash": "0" * 64, "units": {"alpha": "deg"}, **POINT},
        "trim": {"trimmed": True, "saturated": [], "values": POINT, "aircraft": "hera_like"},
        "mdo": {"baseline": {"CL": 0.5}, "optimum": {"CL": 0.6}, "constraints": {}, "feasible": True},
        "train": {"quality": [{"output": "CL", "r2": 0.999, "re": 0.5}], "path": "x.npz"},
        "interact": INTERACTION,
        "write_report": None,
    }

    def fake(name):
        def run(*positional, **named):
            calls.append((name, positional, named))
            outcome = results[name]
            if isinstance(outcome, BaseException):
                raise outcome
            return outcome(**named) if callable(outcome) else outcome

        return run

    for module, names in (
        ("studies", ("analyze", "trim", "mdo", "train", "interact")),
        ("post", ("write_report",)),
    ):
        stand_in = types.ModuleType(f"hera_om.{module}")
        for name in names:
            setattr(stand_in, name, fake(name))
        monkeypatch.setitem(sys.modules, f"hera_om.{module}", stand_in)
    monkeypatch.chdir(tmp_path)
    return types.SimpleNamespace(calls=calls, results=results)


@pytest.fixture
def run(capfd):
    """Run a command in this process: status, standard output, standard error."""

    def call(*words):
        capfd.readouterr()
        status = main(list(words))
        return status, *capfd.readouterr()

    return call


def error_of(out):
    """The error of the one JSON object on standard output."""
    assert out.count("\n") == 1
    return json.loads(out)["error"]


def strict(out):
    """Exactly one JSON object, without NaN."""

    def refuse(name):
        raise AssertionError(f"{name} in JSON")

    assert out.endswith("}\n") and out.count("\n") == 1
    return json.loads(out, parse_constant=refuse)


# --- help, without anything heavy


@pytest.mark.parametrize("words", [["--help"], [], ["mdo", "--help"], ["--version"]])
def test_help_imports_nothing_heavy(words):
    done = python(f"main(sys.argv[1:])\nprint([m for m in {HEAVY} if m in sys.modules])", *words)
    assert done.stdout.splitlines()[-1] == "[]", done.stdout + done.stderr


def test_help_names_every_command_and_ends_with_0():
    done = hera_om("--help")
    assert done.returncode == 0 and not done.stderr
    assert all(re.search(rf"^    {c}\b", done.stdout, re.MULTILINE) for c in COMMANDS)


@pytest.mark.parametrize("command", COMMANDS)
def test_each_command_has_help(command, run):
    status, out, err = run(command, "--help")
    assert status == 0 and not err and "--json" in out
    assert ("--set NAME=VALUE" in out) is (command != "report")


def test_nothing_to_do_shows_the_help_and_is_bad_input(run):
    status, out, err = run()
    assert status == 2 and not out and "COMMAND" in err and "analyze" in err


def test_check_imports_neither_jax_nor_openmdao():
    done = python("main(['check', 'hera_like'])\nprint([m for m in ('jax', 'openmdao') if m in sys.modules])")
    assert done.stdout.splitlines()[-1] == "[]"


# --- check


@pytest.mark.parametrize("name", ["hera_like", "wing_alone", "wing_tail", "rotor_alone", "wing_rotor"])
def test_check_accepts_what_is_shipped(name, run):
    status, out, err = run("check", name, "--json")
    assert status == 0 and not err
    found = strict(out)
    assert found["valid"] is True and found["aircraft"] == name
    assert re.fullmatch("[0-9a-f]{64}", found["hash"])
    assert ("wing" in found["parts"]) is (name != "rotor_alone")
    assert ("rotor" in found["parts"]) is (name not in ("wing_alone", "wing_tail"))


def test_check_for_people(run):
    status, out, err = run("check", "hera_like")
    assert status == 0 and not err
    assert out.startswith("hera_like: valid\n") and "6 (y_kink, theta_tip" in out


def test_check_hash_changes_with_a_number(run):
    hashes = {strict(run("check", "hera_like", "--json", *more)[1])["hash"] for more in ([], ["--set", "alpha=1"])}
    assert len(hashes) == 2


# --- bad input: files


def edit(key, new):
    line = re.compile(rf"^{key} = .*$", re.MULTILINE)
    assert line.search(TEXT)
    return line.sub(new, TEXT, count=1)


FILES = [
    ("wrong type", edit("mach", 'mach = "fast"'), "flight.mach", "fast", "a finite number >= 0 and < 1"),
    ("missing key", edit("mach", ""), "flight.mach", None, "Mach number"),
    ("unknown key", edit("mach", "mach = 0.5\nmatch = 0.5"), "flight.match", 0.5, "did you mean mach"),
    ("NaN", edit("mach", "mach = nan"), "flight.mach", "nan", "a finite number"),
    ("infinite", edit("mach", "mach = inf"), "flight.mach", "inf", "a finite number"),
    ("out of range", edit("mach", "mach = 2.0"), "flight.mach", 2.0, "< 1"),
    ("kink outside", edit("y_m", "y_m = 0.1"), "wing.section.root.y_m", 0.1, "0 for the first section"),
    ("bounds reversed", edit("lower", "lower = 9.0"), "variables.y_kink.lower", 9.0, "less than the upper"),
    ("broken TOML", "[flight\nmach = 1", "", "broken TOML", "a definition in TOML"),
    ("empty", "", "", "an empty file", "a definition in TOML"),
    ("binary", b"\0\1\2", "", "a binary file", "TOML text"),
    ("latin-1", b"name = '\xe9'", "", "a binary file", "TOML text"),
]


@pytest.mark.parametrize("command", ["check", "mdo"])
@pytest.mark.parametrize(("content", "key", "value", "expected"), [r[1:] for r in FILES], ids=[r[0] for r in FILES])
def test_bad_file_is_reported(content, key, value, expected, command, run, studies, tmp_path):
    file = tmp_path / "bad.toml"
    file.write_bytes(content if isinstance(content, bytes) else content.encode())
    status, out, err = run(command, str(file))
    assert status == 2 and not out and str(file) in err and expected in err
    status, out, _ = run(command, str(file), "--json")
    error = error_of(out)
    assert status == 2 and error["kind"] == "input" and error["message"] == err.rstrip("\n")
    (problem,) = [p for p in error["problems"] if p["key"] == key]
    assert problem["file"] == str(file) and expected in problem["expected"]
    assert problem["value"] == value or (not key and problem["value"].startswith(value))
    assert not studies.calls


@pytest.mark.parametrize(
    ("name", "what"),
    [("", "an empty name"), (".", "a folder"), ("x.toml", "no such file"), ("hera_lik", "did you")],
)
def test_no_file(name, what, run, studies):
    status, out, err = run("check", name)
    assert status == 2 and not out and what in err and "hera_like" in err


# --- bad input: --set and options

SETS = [
    ("alpha=nan", "--set alpha", "flight.alpha_deg", "nan", "a finite number"),
    ("alpha=inf", "--set alpha", "flight.alpha_deg", "inf", "a finite number"),
    ("alpha=1e400", "--set alpha", "flight.alpha_deg", "inf", "a finite number"),
    ("alpha=up", "--set alpha", "flight.alpha_deg", "up", "a finite number"),
    ("alpha=", "--set alpha", "flight.alpha_deg", "", "a finite number"),
    ("alpha=100", "--set alpha", "flight.alpha_deg", 100.0, "<= 90"),
    ("alpha", "command line", "--set", "alpha", "NAME=VALUE"),
    ("=1", "command line", "--set", "=1", "NAME=VALUE"),
    ("alhpa=1", "command line", "--set alhpa", "1", "did you mean alpha"),
    ("theta_electrc=45", "command line", "--set theta_electrc", "45", "did you mean theta_electric"),
    ("CL=0.5", "command line", "--set CL", "0.5", "CL is an output"),
    ("name=1", "command line", "--set name", "1", "an input"),
    (
        "wing.section.kink.ym=5",
        "--set wing.section.kink.ym",
        "wing.section.kink.ym",
        5.0,
        "wing.section.kink.y_m",
    ),
    ("lattice.wing_spanwise=1.5", "--set lattice.wing_spanwise", "lattice.wing_spanwise", 1.5, "an integer"),
    ("y_kink=9", "--set y_kink", "wing.section.kink.y_m", 9.0, "between the bounds 3.6 and 8"),
    ("theta_hybrid=70", "--set theta_hybrid", "rotor.hybrid.beta75_deg", 70.0, "40 to 60"),
]


@pytest.mark.parametrize(("text", "file", "key", "value", "expected"), SETS, ids=[r[0] for r in SETS])
def test_bad_assignment_is_reported(text, file, key, value, expected, run):
    status, out, _ = run("check", "hera_like", "--json", "--set", text)
    assert status == 2
    (problem,) = [p for p in error_of(out)["problems"] if p["key"] == key]
    assert (problem["file"], problem["value"]) == (file, value) and expected in problem["expected"]


def test_every_fault_of_the_command_line_and_the_file_is_in_one_report(run, studies, tmp_path):
    file = tmp_path / "bad.toml"
    file.write_text(edit("z_root_m", 'z_root_m = "high"'), "utf-8")
    options = ("--db", str(tmp_path), "--max-iterations", "many", "--aero", "latice", "--surrogate", "s.npz")
    status, out, _ = run("mdo", str(file), "--set", "alhpa=1", "--set", "mach=2", *options, "--json")
    assert status == 2 and not studies.calls
    assert [p["key"] for p in error_of(out)["problems"]] == [
        "--max-iterations",
        "--db",
        "--surrogate",
        "--aero",
        "--set alhpa",
        "flight.mach",
        "wing.z_root_m",
    ]


OPTIONS = [
    (["frob"], "choose from", None),
    (["check"], "AIRCRAFT", None),
    (["check", "hera_like", "--jso"], "unrecognized", None),
    (["trim", "hera_like", "--method", "magic"], "choose from", None),
    (["mdo", "hera_like", "--driver", "slsqp"], "choose from", None),
    (["trim", "hera_like", "--load-factor", "nan"], "--load-factor", "a finite number"),
    (["trim", "hera_like", "--load-factor", "1g"], "--load-factor", "a finite number"),
    (["mdo", "hera_like", "--max-iterations", "0"], "--max-iterations", "an integer >= 1"),
    (["mdo", "hera_like", "--db", "no/where.db"], "--db", "a folder that exists"),
    (["mdo", "hera_like", "--db", "precious.txt"], "--db", "this is another file"),
    (["train", "hera_like", "--samples", "1e3"], "--samples", "an integer"),
    (["train", "hera_like", "--seed", "-1"], "--seed", "an integer"),
    (["train", "hera_like", "--out", "folder"], "--out", "ends in .npz"),
    (["train", "hera_like", "--out", "precious.npz"], "--out", "this is another file"),
    (["trim", "hera_like", "--aero", "surrogate"], "hera_like_surrogate.npz", "no such file"),
    (["trim", "hera_like", "--surrogate", "s.npz"], "--surrogate", "it goes with --aero surrogate"),
    (["trim", "hera_like", "--aero", "surrogat"], "--aero", "did you mean surrogate"),
    (["report"], "DB", None),
    (["report", "no.db"], "no.db", "the database of a run"),
    (["report", "precious.txt"], "no database", "the database of a run"),
    (["report", "empty.db"], "an empty file", "the database of a run"),
    (["report", "."], "a folder", "the database of a run"),
    (["report", "run.db", "--out", "run.db"], "--out", "this is another file"),
]


@pytest.mark.parametrize(("words", "named", "expected"), OPTIONS, ids=[" ".join(r[0]) for r in OPTIONS])
def test_bad_option_is_reported(words, named, expected, run, studies, tmp_path):
    for name, content in (
        ("precious.txt", b"my notes"),
        ("precious.npz", b"my notes"),
        ("empty.db", b""),
        ("run.db", SQLITE),
    ):
        (tmp_path / name).write_bytes(content)
    status, out, err = run(*words)
    assert status == 2 and not out and named in err and (expected or "lists") in err
    status, out, _ = run(*words, "--json")
    assert status == 2 and error_of(out)["kind"] == "input" and error_of(out)["problems"]
    assert not studies.calls
    assert (tmp_path / "precious.txt").read_bytes() == b"my notes"


# --- interaction


def test_interaction_shows_both_tables_and_the_parts(run, studies):
    status, out, err = run("interaction", "hera_like")
    assert status == 0 and not err
    assert re.search(r"0 deg +thrust change +5\.5 +11\.21 +%", out)
    assert re.search(r"Fuselage \+ tail +CZ_alpha +0\.0123 +0\.014139 +1/deg", out)
    assert "Added by the slipstreams at 0 deg" in out and re.search(r"rotors +0\.25", out)
    assert strict(run("interaction", "hera_like", "--json")[1])["differences"][0]["ratio"] == 0.49


def test_interaction_refuses_what_is_no_folder(run, studies, tmp_path):
    (tmp_path / "file").write_text("mine")
    status, out, _ = run("interaction", "hera_like", "--out", "file", "--json")
    (problem,) = error_of(out)["problems"]
    assert status == 2 and problem["key"] == "--out" and problem["value"] == "file" and not studies.calls
    assert (tmp_path / "file").read_text() == "mine"


def test_analysis_shows_parts(run, studies):
    studies.results["analyze"] |= {"parts": {"wing": PART, "rotors": PART}}
    out = run("analyze", "hera_like")[1]
    assert re.search(r"Parts.*\n.*CX +CZ +Cm.*\n +wing +0\.25", out)


# --- what reaches the studies


ASSIGNED = [
    ("alpha=-2.5", lambda a: a.flight.alpha_deg, -2.5),
    ("beta=3", lambda a: a.flight.beta_deg, 3.0),
    ("mach=0.3", lambda a: a.flight.mach, 0.3),
    ("altitude=1000", lambda a: a.flight.altitude_m, 1000.0),
    ("p_hat=0.1", lambda a: a.flight.p_hat, 0.1),
    ("q_hat=0.01", lambda a: a.flight.q_hat, 0.01),
    ("r_hat=0.1", lambda a: a.flight.r_hat, 0.1),
    ("delta_e=-4", lambda a: a.flight.delta_e_deg, -4.0),
    ("delta_a=4", lambda a: a.flight.delta_a_deg, 4.0),
    ("delta_r=4", lambda a: a.flight.delta_r_deg, 4.0),
    ("theta_hybrid=50", lambda a: a.rotor[0].beta75_deg, 50.0),
    ("theta_electric=50", lambda a: a.rotor[1].beta75_deg, 50.0),
    ("theta_tip=-1", lambda a: a.wing.section[2].twist_deg, -1.0),
    ("y_kink = 6", lambda a: a.wing.section[1].y_m, 6.0),
    ("htail.S_m2=12", lambda a: a.htail.S_m2, 12.0),
    ("lattice.wing_spanwise=16", lambda a: a.lattice.wing_spanwise, 16),
]


@pytest.mark.parametrize(("text", "get", "value"), ASSIGNED, ids=[r[0] for r in ASSIGNED])
def test_assignment_reaches_the_definition(text, get, value, run, studies):
    assert run("analyze", "hera_like", "--set", text)[0] == 0
    ((name, (aircraft,), named),) = studies.calls
    assert name == "analyze" and not named and get(aircraft) == value


def test_last_assignment_counts_whatever_it_is_called(run, studies):
    run("analyze", "hera_like", "--set", "alpha=1", "--set", "flight.alpha_deg=2", "--set", "mach=0.3")
    flight = studies.calls[0][1][0].flight
    assert (flight.alpha_deg, flight.mach) == (2.0, 0.3)


def test_assignment_completes_a_definition_without_condition(run, studies, tmp_path):
    file = tmp_path / "wing.toml"
    text = (resources.files("hera_om.aircraft") / "data" / "wing_alone.toml").read_text("utf-8")
    file.write_text(re.sub(r"(?m)^mach = .*$", "", text), "utf-8")
    assert run("check", str(file))[0] == 2
    assert run("check", str(file), "--set", "mach=0.2")[0] == 0


def test_options_reach_the_studies(run, studies, tmp_path):
    (tmp_path / "hera_like_surrogate.npz").write_bytes(b"PK\x03\x04")
    (tmp_path / "other.npz").write_bytes(b"PK\x03\x04")
    (tmp_path / "run.db").write_bytes(SQLITE)
    lines = (
        "trim hera_like --method SLSQP --load-factor 2.5 --db run.db --aero surrogate",
        "trim hera_like --load-factor -1 --aero surrogate --surrogate other.npz",
        "mdo hera_like --driver COBYLA --start high --max-iterations 7 --aero other.npz",
        "mdo hera_like",
        "train hera_like --samples 50 --seed 3",
        "report run.db",
        "report run.db --out page.htm",
    )
    assert [run(*line.split())[0] for line in lines] == [0] * len(lines)
    named = [{k: v for k, v in call[2].items() if k != "progress"} for call in studies.calls]
    aero = "hera_like_surrogate.npz"
    lattice = {"driver": "SLSQP", "aero": "lattice", "database": "mdo.db", "start": "baseline"}
    assert named[:5] == [
        {"method": "SLSQP", "load_factor": 2.5, "database": "run.db", "aero": aero},
        {"method": "solve", "load_factor": -1.0, "database": None, "aero": "other.npz"},
        {**lattice, "driver": "COBYLA", "aero": "other.npz", "start": "high", "max_iterations": 7},
        {**lattice, "max_iterations": None},
        {"samples": 50, "seed": 3, "out": aero},
    ]
    assert [call[1] for call in studies.calls[5:]] == [
        (Path("run.db"), Path("run.html")),
        (Path("run.db"), Path("page.htm")),
    ]


# --- what comes back


def test_json_is_one_strict_object_whatever_the_libraries_print(run, studies):
    def noisy(progress, **_):
        print("Optimization terminated successfully")
        os.write(1, b"from the descriptor\n")
        ctypes.CDLL(None).printf(b"from the C library\n")
        progress(3, -2.5e6, 1e-3, 4.5)
        progress(4, None, None, 5)
        result = {"CL": np.float64(0.5), "CD": float("nan"), "t2_spiral": -np.inf, "n": np.int64(3)}
        more = {
            "cl_span": np.arange(2.0),
            "roots": [1 + 2j],
            "ok": np.bool_(True),
            "file": Path("a"),
            "none": None,
        }
        return {"baseline": result, "optimum": more, "constraints": {}, "feasible": np.True_}

    studies.results["mdo"] = noisy
    status, out, err = run("mdo", "hera_like", "--json")
    assert status == 0
    assert strict(out) == {
        "baseline": {"CL": 0.5, "CD": None, "t2_spiral": None, "n": 3},
        "optimum": {"cl_span": [0.0, 1.0], "roots": [[1.0, 2.0]], "ok": True, "file": "a", "none": None},
        "constraints": {},
        "feasible": True,
    }
    assert all(text in err for text in ("Optimization", "from the descriptor", "from the C library"))
    assert re.search(r"^ +3  objective -2500000 +worst violation +1.00e-03 +4.5 s$", err, re.MULTILINE)
    assert re.search(r"^ +4  the analysis failed here +5.0 s$", err, re.MULTILINE)


def test_analysis_for_people(run, studies):
    status, out, err = run("analyze", "hera_like")
    assert status == 0 and not err
    assert re.search(r"^  alpha +1.25  deg$", out, re.MULTILINE)
    assert re.search(r"^  CD_profile +120.0 +40.0$", out, re.MULTILINE)
    assert re.search(r"^ +alpha +q +theta_hybrid$", out, re.MULTILINE)
    assert re.search(r"^  CL +6.4321 +- +0.0123$", out, re.MULTILINE)
    assert re.search(r"^  group +theta \[deg\] +thrust \[N\] +power \[W\]$", out, re.MULTILINE)
    assert re.search(r"^  hybrid +46.5 +5600 +1.1e\+06$", out, re.MULTILINE)
    assert re.search(r"^  omega_sp +2.05 +rad/s$", out, re.MULTILINE)


def test_a_poor_result_is_still_shown(run, studies):
    for name in ("analyze", "trim", "mdo", "train"):
        studies.results[name] = {"trimmed": True, "feasible": True}
        status, _, err = run(name, "hera_like")
        assert (status, err) == (0, "")


def test_trim_that_saturates_is_shown_and_fails(run, studies):
    bounds = {"alpha": (-5.0, 15.0), "delta_e": (-25.0, 25.0)}
    studies.results["trim"] |= {
        "trimmed": False,
        "saturated": ["delta_e"],
        "bounds": bounds,
        "values": POINT | {"delta_e": -25.0},
    }
    status, out, err = run("trim", "hera_like")
    assert status == 3 and err == "the aircraft is not trimmed: delta_e at its bound\n"
    assert "NOT TRIMMED" in out
    assert re.search(r"^  delta_e +-25  deg +-25 +25  at its bound$", out, re.MULTILINE)
    status, out, _ = run("trim", "hera_like", "--json")
    found = strict(out)
    assert status == 3 and found["values"]["delta_e"] == -25.0
    assert found["error"]["kind"] == "infeasible" and found["error"]["problems"][0]["key"] == "delta_e"


def test_infeasible_optimum_is_shown_and_fails(run, studies):
    studies.results["mdo"] = {
        "aircraft": "hera_like",
        "baseline": {"m_wing": 3300.0, "y_kink": 5.6, "cl_span": [1.0]},
        "optimum": {"m_wing": 2805.0, "y_kink": 5.6, "cl_span": [1.0]},
        "constraints": {
            "omega_sp": {"value": 2.1, "lower": 2.3, "upper": None, "margin": -0.2, "multiplier": 1.5},
            "RFC": {"value": 1.6, "lower": 1.5, "upper": None, "margin": 0.1, "multiplier": 0.0},
        },
        "gain": {"induced drag": 1.25, "wing mass": 4.5},
        "feasible": False,
    }
    status, out, err = run("mdo", "hera_like")
    assert status == 3 and err == "the result is infeasible: omega_sp\n"
    assert "INFEASIBLE" in out and "cl_span" not in out and "record: mdo.db" in out
    assert re.search(r"^  m_wing +3300 +2805 +-15.00  kg$", out, re.MULTILINE)
    assert re.search(r"^  omega_sp +2.1 +2.3 +- +-0.2 +1.5$", out, re.MULTILINE)
    assert re.search(r"^  wing mass +4.5$", out, re.MULTILINE)
    status, out, _ = run("mdo", "hera_like", "--json")
    problem = {"file": "", "key": "omega_sp", "value": 2.1, "expected": ">= 2.3"}
    assert status == 3 and strict(out)["error"]["problems"] == [problem]
    assert strict(out)["optimum"]["m_wing"] == 2805.0


class AnalysisError(Exception):
    __module__ = "openmdao.core.analysis_error"


FAILURES = [
    ("trim", AnalysisFailure("no root", "rotor hybrid", "lower the pitch"), 3, "analysis", "rotor hybrid"),
    ("mdo", AnalysisError("aero: not finite: CL"), 3, "analysis", "not finite: CL"),
    ("mdo", RecordError("s.npz: damaged"), 3, "record", "s.npz: damaged"),
    ("report", RecordError("run.db: damaged"), 2, "record", "run.db: damaged"),
    ("trim", InputError([Problem("hera_like", "rotor", None, "a rotor")]), 2, "input", "expected a rotor"),
    ("analyze", ZeroDivisionError("division\nby zero"), 1, "internal", "ZeroDivisionError: division by zero"),
    ("train", KeyboardInterrupt(), 130, "interrupted", "interrupted"),
]


@pytest.mark.parametrize(("command", "error", "expected", "kind", "text"), FAILURES)
def test_failure_ends_with_its_status(command, error, expected, kind, text, run, studies, tmp_path):
    (tmp_path / "run.db").write_bytes(SQLITE)
    studies.results["write_report" if command == "report" else command] = error
    words = (command, "run.db" if command == "report" else "hera_like")
    status, out, err = run(*words)
    assert status == expected and not out and text in err and "Traceback" not in err
    assert err.count("\n") == 1 or kind == "input"
    status, out, _ = run(*words, "--json")
    assert status == expected and error_of(out)["kind"] == kind and text in error_of(out)["message"]
    assert isinstance(error_of(out)["problems"], list) and ("internal" == kind) is ("--debug" in err)


def test_debug_shows_the_traceback(run, studies):
    studies.results["analyze"] = ZeroDivisionError("x")
    status, out, err = run("analyze", "hera_like", "--debug", "--json")
    assert status == 1 and "Traceback" in err and error_of(out)["kind"] == "internal"


def test_interruption_names_the_database_that_is_safe(run, studies, tmp_path):
    def interrupted(database, **_):
        Path(database).write_bytes(SQLITE)
        raise KeyboardInterrupt

    studies.results["mdo"] = interrupted
    assert run("mdo", "hera_like", "--db", "run.db") == (130, "", "interrupted; run.db is safe\n")


def test_ctrl_c_in_a_process_of_its_own(tmp_path):
    code = """
import os, signal, time, types
signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background job starts with it ignored
def mdo(aircraft, database, **_):
    open(database, "wb").write(b"SQLite format 3\\0")
    os.kill(os.getpid(), signal.SIGINT)
    time.sleep(30)
sys.modules["hera_om.studies"] = types.SimpleNamespace(mdo=mdo)
sys.exit(main())
"""
    done = python(code, "mdo", "hera_like", cwd=tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "interrupted; mdo.db is safe\n")


def test_the_package_runs_as_a_module():
    done = subprocess.run(
        [sys.executable, "-m", "hera_om", "check", "hera_like"], capture_output=True, env=ENV, timeout=60
    )
    assert done.returncode == 0 and b"hera_like" in done.stdout + done.stderr


def test_reader_who_has_left_is_no_error():
    code = "import time; time.sleep(0.2); sys.exit(main())"
    for words in (["check", "hera_like"], ["--help"]):
        process = subprocess.Popen(
            [sys.executable, "-c", f"import sys\nfrom hera_om.cli import main\n{code}", *words],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            env=ENV,
        )
        process.stdout.close()
        with process.stderr:
            assert process.stderr.read() == b""
        assert process.wait(timeout=60) == 0


def test_output_that_cannot_be_written_is_no_success():
    if not Path("/dev/full").exists():
        pytest.skip("no /dev/full")
    with open("/dev/full", "wb") as full:
        done = hera_om("check", "hera_like", capture_output=False, stdout=full, stderr=subprocess.PIPE)
    assert done.returncode == 1 and done.stderr.startswith("hera-om: standard output: No space")
    assert done.stderr.count("\n") == 1


def test_name_that_the_terminal_cannot_show(tmp_path):
    file = tmp_path / "a.toml"
    file.write_text(TEXT.replace('name = "hera_like"', 'name = "hélice"', 1), "utf-8")
    env = ENV | {"PYTHONIOENCODING": "ascii"}
    code = "import sys\nfrom hera_om.cli import main\nsys.exit(main())"
    done = subprocess.run([sys.executable, "-c", code, "check", str(file)], env=env, capture_output=True, text=True)
    assert done.returncode == 0 and done.stdout.startswith("h\\xe9lice: valid")


def test_grid_aligns_figures_to_the_right():
    assert grid([("a", 1.0, "m"), ("bc", -12.5, None), ("d", None, "kg")], ("", "value", "unit"), indent="") == (
        "    value  unit\na       1  m\nbc  -12.5  -\nd       -  kg"
    )
