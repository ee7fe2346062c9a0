"""Frames of a run: values, units, and what is absent."""

import math

import pytest

from hera_om import post
from hera_om.aircraft import load_aircraft
from hera_om.post import tables
from hera_om.studies.record import Record


def test_variables(database, synthetic):
    frame = post.variables(database)
    assert list(frame.index) == list(synthetic.start)
    row = frame.loc["y_prop"]
    assert (row["lower"], row["baseline"], row["optimum"], row["upper"]) == (7.44, 8.0, 10.0, 10.24)
    assert row["units"] == "m" and frame.loc["htail_scale", "units"] == ""
    assert row["moved_percent_of_box"] == pytest.approx(100 * 2.0 / 2.8)
    assert frame.loc["A_stringer_root", "place_in_box"] == pytest.approx(1.0)


def test_constraints(database):
    frame = post.constraints(database)
    row = frame.loc["static_margin"]
    assert row["baseline"] == 0.215 and row["optimum"] == 0.287
    assert row["margin"] == pytest.approx(0.063)
    assert math.isnan(frame.loc["RFC", "upper"])
    assert frame.loc["RFC", "multiplier"] == 140.5 and bool(frame.loc["RFC", "active"])
    assert not frame["violated"].any()
    assert frame.loc["omega_sp", "units"] == "rad/s"


def test_margins_come_from_the_snapshots_when_there_is_no_result(synthetic, tmp_path):
    frame = post.constraints(synthetic.write(tmp_path / "a.db", until="optimum"))
    assert frame.loc["static_margin", "margin"] == pytest.approx(0.063)
    assert frame.loc["zeta_ph", "margin"] == pytest.approx(0.0034)
    assert math.isnan(frame.loc["RFC", "multiplier"])


def test_history(database, synthetic):
    frame = post.history(database)
    assert list(frame.index) == list(range(1, 13))
    assert frame.loc[1, "objective"] == synthetic.before["range_fixed_mass"]
    assert frame.loc[12, "y_kink"] == pytest.approx(synthetic.end["y_kink"])
    assert frame.loc[12, "zeta_sp"] == pytest.approx(synthetic.after["zeta_sp"])
    assert frame["success"].all() and frame["worst_violation"].iloc[-1] == 0.0
    assert frame.columns.is_unique


def test_a_failed_evaluation_has_no_numbers_in_the_history(tmp_path, synthetic):
    with Record(tmp_path / "a.db", kind="mdo", aircraft=load_aircraft("hera_like")) as r:
        r.history(synthetic.row(1, 0.0))
        r.history({"iteration": 2, "success": False, "objective": None, "variables": {"y_kink": 5.0}})
    frame = post.history(tmp_path / "a.db")
    assert not frame.loc[2, "success"] and frame.loc[2, "y_kink"] == 5.0
    assert math.isnan(frame.loc[2, "objective"]) and math.isnan(frame.loc[2, "CL"])


def test_comparison(database):
    frame = post.comparison(database)
    row = frame.loc["m_wing"]
    assert row["units"] == "kg" and row["meaning"] == "mass of the wing"
    assert row["change"] == -379.0 and row["change_percent"] == pytest.approx(-100 * 379 / 3300)
    assert frame.loc["delta_e", "change_percent"] == pytest.approx(100 * 0.4 / 1.2)  # up is up, below zero too
    assert frame.loc["y_kink", "units"] == "m" and frame.loc["m_skins", "meaning"] == ""


def test_a_residual_has_no_change_in_percent(tmp_path):
    with Record(tmp_path / "a.db", kind="mdo", aircraft=load_aircraft("wing_alone")) as r:
        r.snapshot("baseline", {"values": {"Cm": -6e-12, "mass_saved": 1e-8, "CL": 0.5}})
        r.snapshot("optimum", {"values": {"Cm": 2e-12, "mass_saved": 350.0, "CL": 0.6}})
    frame = post.comparison(tmp_path / "a.db")
    assert frame["change_percent"].isna().tolist() == [True, True, False]
    assert frame.loc["CL", "change_percent"] == pytest.approx(20.0)


def test_drag_adds_up_to_the_recorded_total(database):
    frame = post.drag(database)
    assert list(frame.index) == [
        "induced, near field",
        "slipstream",
        "profile",
        "fuselage",
        "fixed areas",
        "total",
    ]
    for design in ("baseline", "optimum"):
        assert frame[design].drop("total").sum() == pytest.approx(frame.loc["total", design])
    assert frame.loc["slipstream", "change"] == pytest.approx(-2.2)


def test_what_the_parts_leave_of_the_total_is_shown(database):
    frame = post.masses(database)
    assert frame.loc[("wing", "not itemised"), "baseline"] == pytest.approx(428.4)
    assert frame.loc["wing"]["baseline"].drop("total").sum() == pytest.approx(3300.0)
    assert "not itemised" not in frame.loc["aircraft"].index
    assert frame.loc[("aircraft", "total"), "optimum"] == 28153.0
    assert frame.loc[("aircraft", "fuel"), "change"] == pytest.approx(350.712)


def test_secondary_structure_is_what_primary_and_remainder_leave():
    shot = post.database.Snapshot({"m_wing": 3300.0, "m_primary": 2400.0, "m_remainder": 500.0, "m_caps": 300.0})
    assert tables._wing_parts(shot)["m_secondary"] == 400.0


def test_gain(database):
    split = post.gain(database)
    assert "total" not in split.index
    assert split.sum() == pytest.approx(178.0) and split.name == "range_fixed_mass"


def test_an_unfinished_run_has_frames_with_gaps(synthetic, tmp_path):
    path = synthetic.write(tmp_path / "a.db", until="head")
    assert post.variables(path)["optimum"].isna().all()
    assert post.history(path).empty and post.comparison(path).empty and post.drag(path).empty
    assert post.masses(path).empty and post.gain(path).empty
    assert post.constraints(path)["margin"].isna().all()


def test_a_run_does_as_well_as_a_path(database):
    run = post.read(database)
    assert post.drag(run).equals(post.drag(str(database)))
