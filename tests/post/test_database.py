"""Reading a database: complete, unfinished, damaged, foreign, from the future."""

import json
import shutil
import sqlite3

import pytest

from hera_om.aircraft import load_aircraft
from hera_om.core.errors import RecordError
from hera_om.post import database as module
from hera_om.post.database import Constraint, cases, read
from hera_om.studies import record


def changed(database, tmp_path, sql, *values):
    """A copy of a database after one statement."""
    path = shutil.copy(database, tmp_path / "copy.db")
    connection = sqlite3.connect(path)
    with connection:
        connection.execute(sql, values)
    connection.close()
    return path


def test_reader_and_writer_agree_on_the_format():
    assert module.FORMAT == record.FORMAT


def test_a_finished_run_is_read_in_full(database, synthetic):
    run = read(database)
    assert run.status == "finished" and run.kind == "mdo" and run.failure is None
    assert run.aircraft == load_aircraft("hera_like")
    assert run.objective.name == "range_fixed_mass" and run.objective.units == "km"
    assert [v.name for v in run.variables] == list(synthetic.end)
    assert run.constraints[3].upper is None
    assert len(run.history) == 12 and run.history[0]["iteration"] == 1
    assert run.baseline.values["CD"] == synthetic.before["CD"] and run.optimum.values["CD"] == synthetic.after["CD"]
    assert run.optimum.arrays["rotors"][1][1] == synthetic.end["y_prop"]
    assert run.result["gain"]["structural_mass"] == 137.0
    with pytest.raises(AttributeError):
        run.kind = "trim"


def test_a_run_without_a_model_has_no_cases(database):
    with pytest.raises(RecordError, match=r"mdo\.db: .*no cases of OpenMDAO"):
        cases(database)


@pytest.mark.parametrize(("until", "rows"), [("head", 0), ("history", 12)])
def test_a_run_without_a_result_is_unfinished(synthetic, tmp_path, until, rows):
    run = read(synthetic.write(tmp_path / "a.db", until=until))
    assert run.status == "unfinished" and run.result is None and run.optimum is None
    assert len(run.history) == rows


@pytest.mark.parametrize(
    ("value", "margin", "relative"),
    [(0.2, 0.2, 0.5), (0.11, 0.01, 0.1), (0.05, -0.05, -0.5), (0.5, -0.1, -0.25)],
)
def test_margin_is_to_the_relatively_nearer_bound(value, margin, relative):
    constraint = Constraint("a", None, 0.1, 0.4)
    assert constraint.margin(value) == pytest.approx(margin)
    assert constraint.relative(value) == pytest.approx(relative)


def test_margin_to_a_bound_of_zero_and_to_none():
    assert Constraint("a", None, 0.0, 0.0).relative(0.3) == -0.3
    assert Constraint("a", None, None, None).relative(1.0) == float("inf")


def test_missing_file_and_folder(tmp_path):
    with pytest.raises(RecordError, match=r"gone\.db: no such file"):
        read(tmp_path / "gone.db")
    with pytest.raises(RecordError, match="a folder, no database"):
        read(tmp_path)
    assert not (tmp_path / "gone.db").exists()


@pytest.mark.parametrize("content", [b"", b"name = 'hera_like'\n" * 50, bytes(range(256)) * 40])
def test_a_file_that_is_no_database(tmp_path, content):
    path = tmp_path / "a.db"
    path.write_bytes(content)
    with pytest.raises(RecordError, match=r"a\.db: (damaged, or no SQLite database|an SQLite database, but not)"):
        read(path)
    assert path.read_bytes() == content


def test_a_database_of_somebody_else(tmp_path):
    connection = sqlite3.connect(tmp_path / "a.db")
    connection.execute("CREATE TABLE metadata (format_version INT)")
    connection.close()
    with pytest.raises(RecordError, match=r"a\.db: an SQLite database, but not one of hera_om"):
        read(tmp_path / "a.db")


@pytest.mark.parametrize("share", [0.02, 0.3, 0.6, 0.95])
def test_a_truncated_database_is_named(database, tmp_path, share):
    whole = database.read_bytes()
    path = tmp_path / "short.db"
    path.write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(RecordError, match=r"short\.db: damaged"):
        read(path)


def test_overwritten_pages_are_named(database, tmp_path):
    whole = bytearray(database.read_bytes())
    page = 4096
    for start in range(2 * page, len(whole), 3 * page):
        whole[start : start + page] = b"\xa5" * page
    path = tmp_path / "spoilt.db"
    path.write_bytes(bytes(whole))
    with pytest.raises(RecordError, match=r"spoilt\.db: damaged"):
        read(path)


def test_a_newer_format_is_not_guessed_at(database, tmp_path):
    path = changed(database, tmp_path, "UPDATE hera_om SET value = '2' WHERE key = 'format'")
    with pytest.raises(RecordError, match=r"copy\.db: format 2 is newer than 1"):
        read(path)


@pytest.mark.parametrize(
    ("sql", "values", "reason"),
    [
        ("DELETE FROM hera_om WHERE key = ?", ("format",), "does not say its format"),
        ("DELETE FROM hera_om WHERE key = ?", ("constraints",), "key 'constraints' is missing"),
        ("UPDATE hera_om SET value = '{\"a' WHERE key = ?", ("definition",), "definition is not JSON"),
        ("UPDATE hera_om SET value = '[{\"name\": 1}]' WHERE key = ?", ("variables",), "missing .* argument"),
        ("UPDATE hera_om SET value = '[1]' WHERE key = ?", ("provenance",), "damaged"),
        (
            "UPDATE hera_om SET value = '{\"units\": {}}' WHERE key = ?",
            ("snapshot:optimum",),
            "key 'values' is missing",
        ),
        ("UPDATE hera_om_history SET value = ? WHERE iteration = 3", ("{",), "history row 3 is not JSON"),
        ("DROP TABLE hera_om_history", (), "not one of hera_om"),
    ],
)
def test_damage_inside_is_named(database, tmp_path, sql, values, reason):
    path = changed(database, tmp_path, sql, *values)
    with pytest.raises(RecordError, match=rf"copy\.db: .*{reason}"):
        read(path)


def test_a_definition_that_no_longer_loads_is_an_error_only_when_asked_for(database, tmp_path):
    path = changed(database, tmp_path, "UPDATE hera_om SET value = ? WHERE key = 'definition'", json.dumps("name = 3"))
    run = read(path)
    with pytest.raises(RecordError, match=r"copy\.db: the recorded definition does not load"):
        _ = run.aircraft


def test_a_missing_number_is_nan(database, tmp_path):
    shot = json.dumps({"values": {"CL": None, "CD": 1}})
    path = changed(database, tmp_path, "UPDATE hera_om SET value = ? WHERE key = 'snapshot:optimum'", shot)
    values = read(path).optimum.values
    assert values["CL"] != values["CL"] and values["CD"] == 1.0


def test_a_write_protected_database_is_readable(database, tmp_path):
    path = shutil.copy(database, tmp_path / "copy.db")
    path.chmod(0o444)
    assert read(path).status == "finished"
