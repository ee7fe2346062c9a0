"""Bad input: every error at once, each with file, key, value and what was expected; never another error."""

# ruff: noqa: E501  (a row of the table reads best as one line)

import json
import os
import re
from importlib import resources

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from hera_om.aircraft import Aircraft, load_aircraft, loads
from hera_om.core.errors import InputError, Problem

TEXT = (resources.files("hera_om.aircraft") / "data" / "hera_like.toml").read_text("utf-8")
FILE = "x.toml"


def report(text, file=FILE):
    with pytest.raises(InputError) as caught:
        loads(text, file)
    return caught.value


def edit(table, key, new, text=TEXT):
    """The text with the line of a key replaced; the table is found by its heading or the name of its item."""
    heading, _, item = table.partition(":")
    start = 0 if not heading else text.index(heading)
    if item:
        start = text.index(f'name = "{item}"', start)
    lines = re.compile(rf"^{re.escape(key)} = .*$", re.MULTILINE)
    found = lines.search(text, start)
    assert found, (table, key)
    return text[: found.start()] + new + text[found.end() :]


ROWS = [f"{a},1e6,0,{0.1 * a},0.01" for a in range(-12, 14, 3)]
TABLE = json.dumps("\n".join(["alpha_deg,reynolds,mach,cl,cd", *ROWS]))  # as text of TOML
FAILED = "{ rotor = 'electric', number = 2, side = 'port', state = 'stopped' }"

ONE_FAULT = [
    # table, key, new line -> key of the report, value, part of what was expected
    ("[flight]", "mach", 'mach = "fast"', "flight.mach", "fast", "a finite number >= 0 and < 1"),
    ("[flight]", "mach", "mach = true", "flight.mach", True, "a finite number"),
    ("[flight]", "mach", "mach = 1979-05-27", "flight.mach", "1979-05-27", "a finite number"),
    ("[flight]", "mach", "mach = [0.5]", "flight.mach", "an array of 1", "a finite number"),
    ("[flight]", "mach", "mach = 1.0", "flight.mach", 1.0, "< 1"),
    ("[flight]", "mach", "", "flight.mach", None, "Mach number"),
    ("[flight]", "mach", "mach = inf", "flight.mach", float("inf"), "a finite number"),
    ("[flight]", "altitude_m", "altitude_m = 1e9", "flight.altitude_m", 1e9, "<= 20000"),
    ("[flight]", "mach", "mach = 0.5\nmatch = 0.5", "flight.match", 0.5, "did you mean mach"),
    ("[wing]", "z_root_m", "z_root_m = 1.3\nspan_m = 29.0", "wing.span_m", 29.0, "known keys: x_le_root_m"),
    ("", "name", 'name = ""', "name", "", "a text that is not empty"),
    ("[mission]", "pax", "pax = 72.5", "mission.pax", 72.5, "an integer >= 0"),
    ("[[rotor]]:hybrid", "blades", "blades = 1", "rotor.hybrid.blades", 1, "an integer >= 2"),
    ("[[rotor]]:hybrid", "sense", 'sense = "up"', "rotor.hybrid.sense", "up", "'inboard-up' or 'outboard-up'"),
    ("[[rotor]]:hybrid", "name", 'name = "2 big"', "rotor.2 big.name", "2 big", "a letter, then letters"),
    ("[[rotor]]:hybrid", "blade", 'blade = "mian"', "rotor.hybrid.blade", "mian", "one of main; did you mean main"),
    ("[[rotor]]:hybrid", "y_m", "y_m = 3.0", "rotor.hybrid.y_m", 3.0, "cuts the fuselage"),
    ("[[rotor]]:hybrid", "y_m", "y_m = 1.0", "rotor.hybrid.y_m", 1.0, "its mirror image"),
    ("[[rotor]]:hybrid", "y_m", "y_m = 0.0", "rotor.hybrid.y_m", 0.0, "symmetry plane"),
    ("[[rotor]]:electric", "y_m", "y_m = 7.0", "rotor.electric.y_m", 7.0, "the disks overlap"),
    ("[[rotor]]:hybrid", "beta75_deg", "beta75_deg = 61.0", "rotor.hybrid.beta75_deg", 61.0, "40 to 60"),
    ("[[rotor]]:hybrid", "count_per_side", "count_per_side = 1\nnacelle_diameter_m = 3.0", "rotor.hybrid.nacelle_diameter_m", 3.0, "at most"),
    ("[[rotor]]:hybrid", "beta75_min_deg", "beta75_min_deg = 70.0", "rotor.hybrid.beta75_min_deg", 70.0, "less than"),
    ("[[rotor]]:hybrid", "z_offset_m", "", "rotor.hybrid", "x_ahead_of_leading_edge_m", "either"),
    ("[[rotor]]:hybrid", "z_offset_m", "z_offset_m = 0.0\nx_m = 1.0\nz_m = 0.0", "rotor.hybrid", "x_ahead_of_leading_edge_m, z_offset_m, x_m, z_m", "either"),
    ("[[rotor]]:electric", "spacing_m", "spacing_m = 2.0", "rotor.electric.spacing_m", 2.0, "diameter 2.4"),
    ("[[rotor]]:electric", "x_ahead_of_leading_edge_m", "x_ahead_of_leading_edge_m = -0.5",
     "rotor.electric.x_ahead_of_leading_edge_m", -0.5, "cuts the wing"),
    ("[[rotor]]:electric", "spacing_m", "", "rotor.electric.spacing_m", None, "count_per_side > 1"),
    ("[[rotor]]:electric", "spacing_m", "spacing_m = 7.0", "rotor.electric.y_m", 8.0, "within the semispan 14.5"),
    ("[[wing.section]]:kink", "y_m", "y_m = 15.0", "wing.section.kink.y_m", 15.0, "between 0 (root) and 14.5 (tip)"),
    ("[[wing.section]]:root", "y_m", "y_m = 0.1", "wing.section.root.y_m", 0.1, "0 for the first section"),
    ("[[wing.section]]:tip", "chord_m", "chord_m = 0.0", "wing.section.tip.chord_m", 0.0, "a finite number > 0"),
    ("[[wing.section]]:tip", "chord_m", "chord_m = nan", "wing.section.tip.chord_m", "nan", "a finite number > 0"),
    ("[[wing.section]]:tip", "airfoil", 'airfoil = "NACA 99"', "wing.section.tip.airfoil", "NACA 99", "4- or 5-digit"),
    ("[[wing.section]]:tip", "dihedral_deg", "", "wing.section.tip", "sweep_quarter_deg", "either"),
    ("[[wing.section]]:root", "twist_deg", "z_m = 0.0", "wing.section.root.z_m", 0.0, "absent from the first section"),
    ("[[wing.section]]:kink", "name", 'name = "tip"', "wing.section.tip.name", "tip", "stands once"),
    ("[wing.control]", "aileron", "aileron = { y0_m = 10.2, y1_m = 15.0, hinge = 0.72, limit_deg = 20.0 }",
     "wing.control.aileron.y1_m", 15.0, "at most the semispan 14.5"),
    ("[wing.control]", "aileron", "aileron = { y0_m = 13.0, y1_m = 12.0, hinge = 0.72, limit_deg = 20.0 }",
     "wing.control.aileron.y0_m", 13.0, "less than y1_m = 12"),
    ("[wing.control]", "aileron", "aileron = { y0_m = 9.0, y1_m = 13.0, hinge = 0.72, limit_deg = 20.0 }",
     "wing.control.aileron.y0_m", 9.0, "clear of the flap"),
    ("[wing.control]", "aileron", "aileron = { y0_m = 10.2, y1_m = 13.0, hinge = 0.5, limit_deg = 20.0 }",
     "wing.control.aileron.hinge", 0.5, "behind the rear spar"),
    ("[wing]", "fuel_tank", "fuel_tank = { y0_m = 1.6, y1_m = 20.0 }", "wing.fuel_tank.y1_m", 20.0, "semispan"),
    ("[wing]", "fuselage_joint_y_m", "fuselage_joint_y_m = 15.0", "wing.fuselage_joint_y_m", 15.0, "semispan"),
    ("[wing.structure]", "front_spar", "front_spar = 0.7", "wing.structure.front_spar", 0.7, "rear_spar = 0.62"),
    ("[wing.structure]", "material", 'material = "wood"', "wing.structure.material", "wood", "Al2024-T3, Al7075-T6"),
    ("[htail]", "polar", "polar = { cd_min = 0.01, cl_at_cd_min = 0.5, k = 0.01, re = 1e6, cl_max = 0.4 }",
     "htail.polar.cl_max", 0.4, "more than cl_at_cd_min"),
    ("[htail]", "polar", "polar = { cd_min = -0.01, cl_at_cd_min = 0.5, k = 0.01, re = 1e6, cl_max = 1.4 }",
     "htail.polar.cd_min", -0.01, "> 0"),
    ("[fuselage]", "nose_length_m", "nose_length_m = 25.0", "fuselage.nose_length_m", 25.0, "within length_m"),
    ("[mission]", "V_C_EAS_m_s", "V_C_EAS_m_s = 200.0", "mission.V_C_EAS_m_s", 200.0, "less than V_D_EAS_m_s"),
    ("[mission]", "cruise_fuel_kg", "cruise_fuel_kg = 9e3", "mission.cruise_fuel_kg", 9000.0, "3300 [kg]"),
    ("[reference]", "c_m", "x_m = 12.0", "reference.y_m", None, "all three"),
    ("[[drag_area]]:electric_pods", "rotor", 'rotor = "elektric"', "drag_area.electric_pods.rotor", "elektric",
     "did you mean electric"),
    ("[[drag_area]]:electric_pods", "rotor", 'rotor = "electric"\ny_m = 1.0', "drag_area.electric_pods.y_m", 1.0, "not both"),
    ("[[blade]]", "c", "c = [0.1, 0.1]", "blade.main.c", "2 entries", "r, which has 10"),
    ("[[blade]]", "r", "r = [0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.85, 1.0]", "blade.main.r.8", 0.85, "0.9"),
    ("[[blade]]", "r", "r = [0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 1.1]", "blade.main.r.9", 1.1, "<= 1"),
    ("[[blade]]", "c", "c = [0.78, 0.5, 0.16, 0.165, 0.16, 0.15, 0.135, 0.11, 0.09, 0.06]", "blade.main.c.0", 0.78,
     "overlap"),
    ("[[blade]]", "hub", "hub = 0.25", "blade.main.hub", 0.25, "at most the first station"),
    ("[[blade]]", "hub", "hub = 0.2\nstall_delay = 1", "blade.main.stall_delay", 1, "true or false"),
    ("[[blade]]", "hub", "hub = 0.2\npolar_table = 3", "blade.main.polar_table", 3, "a table"),
    ("[[blade]]", "hub", "hub = 0.2\npolar_table = { file = 'no.csv' }", "blade.main.polar_table.file", "no.csv", "a CSV file"),
    ("[[blade]]", "hub", "hub = 0.2\npolar_table = { }", "blade.main.polar_table", None, "one of file, neuralfoil and csv"),
    ("[[blade]]", "hub", f"hub = 0.2\npolar_table = {{ csv = {TABLE} }}", "blade.main", "polar, polar_table", "one of polar and"),
    ("[[blade]]", "hub", f"hub = 0.2\npolar_table = {{ csv = {TABLE}, extend = 1 }}", "blade.main.polar_table.extend", 1, "true or false"),
    ("[[blade]]", "hub", f"hub = 0.2\npolar_table = {{ csv = {TABLE}, extend = false }}", "blade.main.polar_table.extend",
     False, "true, or a table from -180 to 180 degrees, which a blade needs: x.toml: blade.main.polar_table.csv covers -12 to 12"),
    ("[[blade]]", "hub", f"hub = 0.2\npolar_table = {{ csv = {TABLE}, compressible = 'no' }}",
     "blade.main.polar_table.compressible", "no", "true or false"),
    ("[[blade]]", "hub", f"hub = 0.2\npolar_table = {{ csv = {TABLE}, aspect_ratio = 0.0 }}",
     "blade.main.polar_table.aspect_ratio", 0.0, "a finite number > 0"),
    ("[flight]", "mach", f"mach = 0.5\nfailed = [{FAILED.replace('electric', 'elektric')}]", "flight.failed[0].rotor", "elektric",
     "did you mean electric"),
    ("[flight]", "mach", f"mach = 0.5\nfailed = [{FAILED.replace('2', '3')}]", "flight.failed[0].number", 3, "at most 2"),
    ("[flight]", "mach", f"mach = 0.5\nfailed = [{FAILED.replace('2', '0')}]", "flight.failed[0].number", 0, "an integer >= 1"),
    ("[flight]", "mach", f"mach = 0.5\nfailed = [{FAILED.replace('port', 'left')}]", "flight.failed[0].side", "left",
     "'starboard' or 'port' or 'both'"),
    ("[flight]", "mach", f"mach = 0.5\nfailed = [{FAILED.replace('stopped', 'lost')}]", "flight.failed[0].state", "lost",
     "'windmilling' or 'feathered' or 'stopped'"),
    ("[flight]", "mach", f"mach = 0.5\nfailed = [{FAILED}, {FAILED.replace('port', 'both')}]", "flight.failed[1]",
     "electric_2_both", "not failed already"),
    ("[flight]", "mach", f"mach = 0.5\nfailed = [{FAILED.replace('}', ', pitch = 1 }')}]", "flight.failed[0].pitch", 1,
     "no such key"),
    ("[[mass]]:wing", "x_m", "x_m = nan", "mass.wing.x_m", "nan", "a finite number"),
    ("[[mass]]:wing", "x_m", "x_m = -inf", "mass.wing.x_m", "-inf", "a finite number"),
    ("[[mass]]:wing", "tracks", 'tracks = "wings"', "mass.wing.tracks", "wings", "'rotor:<group>'"),
    ("[[mass]]:wing", "tracks", 'tracks = "rotor:jet"', "mass.wing.tracks", "rotor:jet", "rotor:hybrid"),
    ("[[mass]]:htail", "tracks", 'tracks = "wing"', "mass.htail.tracks", "wing", "one item that tracks wing"),
    ("[[mass]]:fuselage", "m_kg", "m_kg = -1", "mass.fuselage.m_kg", -1, ">= 0"),
    ("[[variables]]:y_kink", "lower", "lower = 9.0", "variables.y_kink.lower", 9.0, "less than the upper bound 8"),
    ("[[variables]]:y_kink", "lower", "lower = 6.0", "wing.section.kink.y_m", 5.6, "between the bounds 6 and 8"),
    ("[[variables]]:y_kink", "path", 'path = "wing.section.kinck.y_m"', "variables.y_kink.path",
     "wing.section.kinck.y_m", "did you mean wing.section.kink.y_m"),
    ("[[variables]]:y_kink", "path", 'path = "lattice.wing_spanwise"', "variables.y_kink.path",
     "lattice.wing_spanwise", "the path of a number"),
    ("[[variables]]:y_kink", "path", 'path = "variables.y_prop.ref"', "variables.y_kink.path",
     "variables.y_prop.ref", "the path of a number"),
    ("[[variables]]:theta_tip", "name", 'name = "y_kink"', "variables.y_kink.name", "y_kink", "stands once"),
    ("[[variables]]:theta_tip", "name", 'name = "static_margin"', "variables.static_margin.name", "static_margin",
     "not an output"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("table", "key", "new", "path", "value", "expected"), ONE_FAULT, ids=[f"{r[3]}={r[4]}" for r in ONE_FAULT]
)
def test_fault_is_named_with_file_key_value_and_expectation(table, key, new, path, value, expected):
    error = report(edit(table, key, new))
    match = [p for p in error.problems if p.key == path and expected in p.expected]
    assert match, str(error)
    assert match[0].file == FILE
    assert match[0].value == value or str(match[0].value) == value
    line = next(line for line in str(error).splitlines() if path in line and expected in line)
    assert line.startswith(FILE)


def test_good_text_has_no_fault():
    assert loads(TEXT).name == "hera_like"


def test_fault_alone_is_reported_alone():
    alone = [row for row in ONE_FAULT if row[0] in ("[flight]", "[wing.structure]", "[fuselage]", "[[blade]]")]
    for table, key, new, *_ in alone:
        if "match" not in new:
            assert len(report(edit(table, key, new)).problems) == 1, new


def test_every_typed_fault_is_in_one_report():
    text = edit("[flight]", "mach", "mach = 2.0")
    text = edit("[wing]", "z_root_m", 'z_root_m = "high"', text)
    text = edit("[[rotor]]:electric", "rpm", "", text)
    text = edit("[htail]", "taper", "taper = 0.6\ntapper = 0.6", text)
    assert {p.key for p in report(text).problems} == {
        "flight.mach",
        "wing.z_root_m",
        "rotor.electric.rpm",
        "htail.tapper",
    }


def test_every_cross_field_fault_is_in_one_report():
    text = edit("[wing.structure]", "front_spar", "front_spar = 0.7")
    text = edit("[[blade]]", "hub", "hub = 0.25", text)
    text = edit("[fuselage]", "nose_length_m", "nose_length_m = 25.0", text)
    text = edit("[[variables]]:y_kink", "path", 'path = "wing.y_kink"', text)
    keys = {p.key for p in report(text).problems}
    assert keys == {
        "wing.structure.front_spar",
        "blade.main.hub",
        "fuselage.nose_length_m",
        "variables.y_kink.path",
    }


def test_unnamed_item_is_told_by_its_place():
    error = report(edit("[[wing.section]]:kink", "name", ""))
    assert error.problems[0].key == "wing.section[1].name"


@pytest.mark.parametrize(
    ("text", "key", "expected"),
    [
        ("flight = 3", "flight", "a table [flight]"),
        ("[[flight]]\nmach = 0.1", "flight", "a table [flight]"),
        ("[rotor]\nname = 'a'", "rotor", "an array of tables [[rotor]]"),
        ("rotor = [1]", "rotor[0]", "a table [[rotor]]"),
        ("wing = { section = [] }", "wing.section", "at least 2 entries"),
        ("wing = { section = 1 }", "wing.section", "an array of tables [[wing.section]]"),
        ("variables = [[1]]", "variables[0]", "a table [[variables]]"),
        (
            "wing = { section = [{ name = 'a', polar = 1 }, 2] }",
            "wing.section[1]",
            "a table [[wing.section]]",
        ),
    ],
)
def test_wrong_kinds_of_tables(text, key, expected):
    assert any(p.key == key and expected in p.expected for p in report(text).problems)


# --- whole files


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "an empty file"),
        ("\n  # only a comment\n", "an empty file"),
        ("name = 'a'\nmach = \n", "at line 2, column 8"),
        ("[flight\n", "broken TOML"),
        ("a = 1\na = 2\n", "broken TOML"),
        ("a = " + "9" * 5000, "broken TOML"),
        ("a = " + "[" * 3000, "broken TOML|nested too deeply"),
        ("a." * 4000 + "a = 1", "nested too deeply"),
        ("name = 'a\ud800'", "broken TOML"),
    ],
)
def test_file_that_is_no_definition(text, said):
    error = report(text)
    assert len(error.problems) == 1
    assert error.problems[0].key == ""
    assert re.search(said, str(error))
    assert FILE in str(error) and "definition in TOML" in str(error)


def test_faults_of_the_file_itself(tmp_path):
    binary, latin, pipe = tmp_path / "binary.toml", tmp_path / "latin.toml", tmp_path / "pipe"
    binary.write_bytes(b"name = 'a'\0\xff")
    latin.write_bytes("name = 'é'".encode("latin-1"))
    os.mkfifo(pipe)
    said = {
        binary: "NUL at byte 10",
        latin: "byte 8 is not UTF-8",
        tmp_path: "a folder",
        tmp_path / "none.toml": "no such file",
        pipe: "a device or pipe",
        "hera_lik": "did you mean hera_like",
        "": "empty",
        "a\0b": "no such file|null",
        "x" * 5000: "name too long",
    }
    for source, words in said.items():
        with pytest.raises(InputError) as caught:
            load_aircraft(source)
        (problem,) = caught.value.problems
        assert re.search(words, str(caught.value), re.IGNORECASE), source
        assert problem.expected and problem.key == ""


def test_file_without_permission(tmp_path, monkeypatch):
    secret = tmp_path / "secret.toml"
    secret.write_text(TEXT, "utf-8")
    secret.chmod(0)
    if os.access(secret, os.R_OK):  # the superuser reads everything: act the refusal
        monkeypatch.setattr("pathlib.Path.read_bytes", _refuse)
    with pytest.raises(InputError, match="Permission denied"):
        load_aircraft(secret)


def _refuse(path):
    raise PermissionError(13, "Permission denied", str(path))


# --- corners of the box


@pytest.mark.parametrize(
    ("variable", "side", "bound", "key", "expected"),
    [
        ("y_prop", "lower", 7.0, "rotor.electric.y_m", "corner y_prop = 7 of the variables"),
        ("y_prop", "upper", 12.5, "rotor.electric.y_m", "within the semispan 14.5"),
        ("y_kink", "upper", 14.6, "wing.section.kink.y_m", "corner y_kink = 14.6"),
        ("htail_scale", "lower", -1.0, "variables.htail_scale.lower", "for htail.scale: a finite number > 0"),
    ],
)
def test_box_must_be_sound_in_its_corners(variable, side, bound, key, expected):
    error = report(edit(f"[[variables]]:{variable}", side, f"{side} = {bound}"))
    assert [p.key for p in error.problems] == [key]
    assert expected in error.problems[0].expected


def test_fault_of_two_variables_together_is_found():
    second = """
[[variables]]
name = "y_hybrid"
path = "rotor.hybrid.y_m"
lower = 4.0
upper = 4.4
"""
    text = edit("[[variables]]:y_prop", "lower", "lower = 7.44", TEXT.replace("# Rough checks", second + "# Rough"))
    (problem,) = report(text).problems
    assert problem.key == "rotor.electric.y_m"
    assert "y_prop = 7.44" in problem.expected and "y_hybrid = 4.4" in problem.expected


# --- overrides


@pytest.mark.parametrize(
    ("path", "value", "expected"),
    [
        ("rotor.electrc.y_m", 8.0, "did you mean rotor.electric.y_m"),
        ("flight.mach", float("nan"), "a finite number"),
        ("flight.mach", 2.0, "< 1"),
        ("flight.mach", "fast", "a finite number"),
        ("blade.main.r.11", 0.5, "the path of a number"),
        ("blade.main.r.x", 0.5, "the path of a number"),
        ("blade.main.r.1", 0.1, "more than the station before it"),
        ("lattice.wing_spanwise", 16.5, "an integer"),
        ("wing", 1.0, "the path of a number"),
        ("wing.section", 1.0, "the path of a number"),
        ("name", 1.0, "the path of a number"),
        ("rotor.electric.y_m", 13.0, "semispan"),
    ],
)
def test_bad_override_is_named(path, value, expected):
    with pytest.raises(InputError) as caught:
        load_aircraft("hera_like", {path: value})
    match = [p for p in caught.value.problems if p.key == path and expected in p.expected]
    assert match and match[0].file == "override", str(caught.value)


def test_overrides_are_applied_and_may_add_what_is_absent():
    aircraft = load_aircraft(
        "hera_like",
        {
            "rotor.electric.y_m": 8.5,
            "blade.main.twist_deg.0": 30.0,
            "lattice.wing_spanwise": 16.0,
            "flight.speed_m_s": 150.0,
            "material.Al7075-T6.Fty_Pa": 4.0e8,
            "reference.S_m2": 71,
        },
    )
    assert aircraft.rotor[1].y_m == 8.5
    assert aircraft.blade[0].twist_deg[0] == 30.0
    assert aircraft.lattice.wing_spanwise == 16
    assert aircraft.flight.speed_m_s == 150.0
    assert aircraft.wing_material().Fty_Pa == 4.0e8
    assert aircraft.reference.S_m2 == 71.0 and type(aircraft.reference.S_m2) is float
    assert load_aircraft("wing_rotor", {"reference.S_m2": 50.0}).reference.S_m2 == 50.0  # the table was absent


def test_faults_of_overrides_and_file_come_together(tmp_path):
    file = tmp_path / "bad.toml"
    file.write_text(edit("[flight]", "mach", "mach = 2.0"), "utf-8")
    with pytest.raises(InputError) as caught:
        load_aircraft(file, {"wing.nothing": 1.0})
    assert {(p.file, p.key) for p in caught.value.problems} == {
        ("override", "wing.nothing"),
        (str(file), "flight.mach"),
    }


def test_rotor_needs_a_speed():
    text = (resources.files("hera_om.aircraft") / "data" / "rotor_alone.toml").read_text("utf-8")
    (problem,) = report(edit("[flight]", "speed_m_s", "", text)).problems
    assert problem.key == "flight.mach" and "since there are rotors" in problem.expected


def test_tail_without_wing_needs_a_reference():
    tail = "[htail]\nS_m2 = 2.0\naspect_ratio = 4.0\ntaper = 1.0\nx_quarter_mac_m = 0.0\n"
    text = f"name = 't'\n[flight]\nmach = 0.1\n{tail}"
    assert [p.key for p in report(text).problems] == ["reference.S_m2", "reference.c_m", "reference.b_m"]
    assert loads(text + "[reference]\nS_m2 = 2.0\nc_m = 0.7\nb_m = 2.8\n").htail.S_m2 == 2.0


def test_rotor_on_the_wing_needs_the_wing():
    text = (resources.files("hera_om.aircraft") / "data" / "rotor_alone.toml").read_text("utf-8")
    text = edit("[[rotor]]", "x_m", "x_ahead_of_leading_edge_m = 1.0", text)
    (problem,) = report(edit("[[rotor]]", "z_m", "z_offset_m = 0.0", text)).problems
    assert problem.key == "rotor.prop.x_ahead_of_leading_edge_m" and "no wing" in problem.expected


def test_a_disk_may_stand_in_the_slipstream_of_another():
    beside = edit("[[rotor]]:hybrid", "y_m", "y_m = 5.2")
    assert "overlap" in report(beside).problems[0].expected
    loads(edit("[[rotor]]:hybrid", "x_ahead_of_leading_edge_m", "x_ahead_of_leading_edge_m = 3.2", beside), FILE)


# --- fuzz: whatever comes in, an aircraft or an InputError comes out


def survives(call):
    try:
        assert isinstance(call(), Aircraft)
    except InputError as error:
        assert error.problems
        assert all(isinstance(p, Problem) and p.expected for p in error.problems)
        assert str(error)
        error.to_json()


@given(st.text())
def test_any_text(text):
    survives(lambda: loads(text))


@given(st.binary())
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_any_bytes(tmp_path, data):
    file = tmp_path / "any.toml"
    file.write_bytes(data)
    survives(lambda: load_aircraft(file))


VALUES = st.one_of(
    st.floats(allow_nan=False, allow_infinity=False).map(repr),
    st.sampled_from(["nan", "-inf", "1e400", "-0.0", "1" + "0" * 400, "true", "[]", "{}", "[[1]]", "07:32:00", '""']),
    st.integers().map(str),
    st.from_regex(r"[A-Za-z0-9 ._:-]{0,12}", fullmatch=True).map(lambda s: f'"{s}"'),
)
LINES = [i for i, line in enumerate(TEXT.splitlines()) if re.match(r"^\w+ = ", line)]


@given(st.lists(st.tuples(st.sampled_from(LINES), VALUES), min_size=1, max_size=3))
@settings(max_examples=200, deadline=None)
def test_any_value_anywhere(edits):
    lines = TEXT.splitlines()
    for index, value in edits:
        lines[index] = f"{lines[index].split(' = ')[0]} = {value}"
    survives(lambda: loads("\n".join(lines)))


@given(st.sampled_from(LINES), st.from_regex(r"[A-Za-z_.]{1,12}", fullmatch=True))
@settings(max_examples=50, deadline=None)
def test_any_key_anywhere(index, key):
    lines = TEXT.splitlines()
    lines[index] = f"{key} = 1.0"
    survives(lambda: loads("\n".join(lines)))


@given(st.lists(st.sampled_from(TEXT.splitlines()), max_size=40))
@settings(deadline=None)
def test_any_shuffle_of_lines(lines):
    survives(lambda: loads("\n".join(lines)))


def test_a_faulty_section_does_not_make_the_array_too_short():
    text = edit(
        "[[wing.section]]:tip", "chord_m", "chord_m = 0.0", edit("[[wing.section]]:root", "chord_m", "chord_m = 0")
    )
    assert {p.key for p in report(text).problems} == {"wing.section.root.chord_m", "wing.section.tip.chord_m"}
