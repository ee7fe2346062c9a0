"""AVL geometry files: what is read, that writing and reading give the same aircraft, signs of controls, faults."""

import math
import tomllib
import warnings

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import hera_om
from hera_om.aircraft import (
    AvlWarning,
    commands,
    lifting_surfaces,
    load_aircraft,
    read_avl,
    reference_b,
    reference_c,
    reference_S,
    write_avl,
)
from hera_om.aircraft.avl_read import avl_tables, command_of
from hera_om.aircraft.spacing import segment_points
from hera_om.core.errors import InputError
from hera_om.core.mean_lines import mean_line

TEXT = """! made up for the tests
# another comment
Small model ! of everything
0.25
0  0  0.0
12.5  1.25  10.0   extra words
0.4, 0.0, 0.1
0.0125

SURFACE
Main wing
8  1.0  12  1.0
COMPONENT
1
YDUPLICATE
0.0
SCALE
2.0 1.0 1.0
TRANSLATE
1.0 0.0 0.5
ANGLE
1.5
SECTION
0.0 0.0 0.0  0.7  0.0
NACA
2412
CONTROL
flap 1.0 0.75 0. 0. 0. 1
SECTION
0.0 2.0 0.0  0.7  0.0
AIRFOIL
{points}
CONTROL
flap 1.0 0.75 0. 0. 0. 1
control
Aileron -1.0 0.70 0. 0. 0. -1
SECT
0.1 5.0 0.3  0.4 -2.0
AFILE
tip.dat
CONTROL
Aileron -1.0 0.80 0. 0. 0. -1
SURFACE
fin
5 1.0
SECTION
4.0 0.0 0.0 1.0 0.0 4 -2.0
CONTROL
rudder 1.0 0.6 0 0 1 1
SECTION
4.2 0.0 0.5 0.8 0.0 6 1.5
CONTROL
rudder 1.0 0.6 0 0 1 1
SECTION
4.5 0.0 1.5 0.5 0.0
CONTROL
rudder 0.5 0.6 0 0 1 1
"""
POINTS = "1.0 0.0\n0.5 0.06\n0.2 0.06\n0.0 0.0\n0.2 -0.03\n0.5 -0.02\n1.0 0.0"
TIP = "tip\n" + POINTS.replace("0.06", "0.05") + "\n"


@pytest.fixture
def model(tmp_path):
    """The text above as a file, with its coordinate file; some of it replaced."""

    def make(*changes, name="model.avl"):
        text = TEXT.format(points=POINTS)
        for old, new in changes:
            assert old in text, old
            text = text.replace(old, new)
        (tmp_path / "tip.dat").write_text(TIP)
        path = tmp_path / name
        path.write_text(text)
        return path

    return make


def quiet(function, *arguments):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", AvlWarning)
        return function(*arguments)


def test_header_and_sections(model):
    aircraft = quiet(read_avl, model())
    reference = aircraft.reference
    assert (aircraft.name, aircraft.flight.mach) == ("Small model", 0.25)
    assert (reference.S_m2, reference.c_m, reference.b_m) == (12.5, 1.25, 10.0)
    assert (reference.x_m, reference.y_m, reference.z_m) == (0.4, 0.0, 0.1)
    assert aircraft.drag_area[0].value_m2 == 0.0125 * 12.5
    main, fin = lifting_surfaces(aircraft)
    assert (main.name, main.symmetric, fin.in_plane) == ("Main_wing", True, True)
    assert main.x_le == (1.0, 1.0, 1.2) and main.chord == (1.4, 1.4, 0.8)  # scaled, then shifted
    assert main.z == (0.5, 0.5, 0.8) and main.twist_deg == (0.0, 0.0, -2.0) and main.incidence_deg == 1.5
    assert (main.chordwise, main.chordwise_law, main.spanwise, main.spanwise_law) == (8, 1.0, 12, 1.0)
    assert main.airfoils[0] == "NACA 2412" and main.airfoils[1].z[1] == 0.06 and main.airfoils[2].z[1] == 0.05
    assert fin.airfoils == ("flat",) * 3


def test_strips_stand_where_avl_has_them(model):
    main, fin = lifting_surfaces(quiet(read_avl, model()))
    width = math.hypot(3.0, 0.3)
    edges = (1 - np.cos(np.pi * np.arange(13) / 12)) / 2
    nearest = int(np.argmin(np.abs(edges - 2.0 / (2.0 + width))))
    assert [s.count for s in main.segments] == [nearest, 12 - nearest]
    np.testing.assert_allclose(segment_points(main.segments[0])[::2], edges[: nearest + 1] / edges[nearest])
    assert [(s.count, s.law, s.start, s.end) for s in fin.segments] == [(4, -2.0, 0.0, 1.0), (6, 1.5, 0.0, 1.0)]


def test_controls_move_as_the_file_says(model):
    """The file's aileron is turned round, its rudder too; sizes, hinges and axes stay."""
    with pytest.warns(AvlWarning) as caught:
        main, fin = lifting_surfaces(read_avl(model()))
    notes = [str(w.message) for w in caught]
    assert any("delta_r is minus the file's rudder" in n for n in notes)
    assert any("delta_a is minus the file's Aileron" in n for n in notes)
    flap, aileron = main.controls
    assert (flap.command, flap.gain, flap.mirror, flap.hinge) == ("delta_f", (1.0, 1.0), 1.0, (0.75, 0.75))
    assert flap.ends == (0.0, pytest.approx(2.0))
    assert (aileron.command, aileron.gain, aileron.mirror) == ("delta_a", (1.0, 1.0), -1.0)
    assert aileron.hinge == (0.7, 0.8) and aileron.ends[1] == main.station[-1]
    inner, outer = fin.controls  # the gain changes over the outer segment alone
    assert (inner.gain, outer.gain) == ((-1.0, -1.0), (-1.0, -0.5)) and inner.axis == (0.0, 0.0, 1.0)
    assert commands(quiet(read_avl, model())) == ("delta_a", "delta_r", "delta_f")


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_our_rudder_goes_to_port_whatever_the_file_chose(model, sign):
    """A fin that runs up: the right-hand rule takes the trailing edge to starboard, our command to port."""
    path = model(("rudder 1.0", f"rudder {sign}"), ("rudder 0.5", f"rudder {0.5 * sign}"))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        fin = lifting_surfaces(read_avl(path))[1]
    assert [c.gain for c in fin.controls] == [(-1.0, -1.0), (-1.0, -0.5)]
    assert any("minus the file's rudder" in str(w.message) for w in caught) is (sign > 0)


@pytest.mark.parametrize(
    ("name", "command"),
    [("elevator", "delta_e"), ("Elev1", "delta_e"), ("ail", "delta_a"), ("RUDDER", "delta_r"), ("flap_in", "delta_f"),
     ("delta_f", "delta_f"), ("elevon", None), ("flaperon", None), ("slat", None)],
)  # fmt: skip
def test_commands_by_name(name, command):
    assert command_of(name) == command


def test_a_control_without_a_command_is_left_out_with_a_warning(model):
    with pytest.warns(AvlWarning, match="control slat is left out"):
        aircraft = read_avl(model(("flap 1.0", "slat 1.0")))
    assert commands(aircraft) == ("delta_a", "delta_r")


def test_what_has_no_counterpart_is_left_out_with_a_warning(model):
    more = "CDCL\n0 0.01 0.5 0.006 1 0.01\nCLAF\n1.1\nDESIGN\nt 1.0\nBODY\nhull\n20 1.0\nBFIL\nhull.dat\n"
    with pytest.warns(AvlWarning) as caught:
        assert read_avl(model(("SURFACE\nfin", more + "SURFACE\nfin"))) == quiet(read_avl, model())
    notes = " ".join(str(w.message) for w in caught)
    assert all(word in notes for word in ("CDCL", "CLAF", "DESIGN", "BODY"))


def test_a_half_model_is_mirrored(model):
    half = quiet(read_avl, model(("0  0  0.0", "1  0  0.0"), ("YDUPLICATE\n0.0\n", "")))
    assert half == quiet(read_avl, model())


# --- round trips


def test_reading_writing_reading_gives_the_same_aircraft(model, tmp_path):
    first = quiet(read_avl, model())
    out = tmp_path / "out.avl"
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # nothing is lost, nothing turned round a second time
        write_avl(first, out)
        second = read_avl(out)
    assert second == first


def test_the_reference_case_survives_and_is_that_of_its_table(reference, tmp_path):
    folder = reference / "atr_like"
    source = tomllib.loads((folder / "wing_tail.toml").read_text("utf-8"))
    aircraft = quiet(read_avl, folder / "wing_tail.avl")
    quiet(write_avl, aircraft, tmp_path / "x.avl")
    assert read_avl(tmp_path / "x.avl") == aircraft
    wing, tail, fin = lifting_surfaces(aircraft)
    assert [s.count for s in wing.segments] == source["avl_lattice"]["spanwise_wing"]
    assert (tail.spanwise, fin.spanwise) == (16, 14) and {s.chordwise for s in (wing, tail, fin)} == {10}
    rows = np.array(source["wing"]["sections"])
    for k, values in ((1, wing.x_le), (2, wing.z), (3, wing.chord), (4, wing.twist_deg)):
        np.testing.assert_allclose(values, np.interp(wing.y, rows[:, 0], rows[:, k]), atol=1e-9)
    aileron, elevator, rudder = (s.controls[0] for s in (wing, tail, fin))
    at = np.interp(aileron.ends, wing.station, wing.y)
    np.testing.assert_allclose(at, [source["wing"]["aileron"]["y0"], source["wing"]["aileron"]["y1"]], atol=1e-9)
    assert (aileron.hinge[0], elevator.hinge[0], rudder.hinge[0]) == (0.72, 0.65, 0.65)
    assert (aileron.gain[0], aileron.mirror, elevator.gain[0], rudder.gain[0]) == (1.0, -1.0, 1.0, -1.0)
    assert area(wing) == pytest.approx(source["reference"]["S"], rel=0.02)


def area(surface):
    pairs = zip(surface.chord[:-1], surface.chord[1:], np.diff(stations(surface)), strict=True)
    return (2 if surface.symmetric else 1) * sum((a + b) / 2 * w for a, b, w in pairs)


@pytest.mark.parametrize("name", ["hera_like", "wing_tail", "wing_alone"])
def test_a_shipped_aircraft_becomes_an_avl_file(tmp_path, name):
    """Places, areas, controls and mean lines are those of the definition."""
    aircraft = load_aircraft(name)
    quiet(write_avl, aircraft, tmp_path / "x.avl")
    again = quiet(read_avl, tmp_path / "x.avl")
    assert reference_S(again) == pytest.approx(reference_S(aircraft))
    assert (reference_c(again), reference_b(again)) == (reference_c(aircraft), reference_b(aircraft))
    x = np.linspace(0.02, 0.98, 13)
    for old, new in zip(lifting_surfaces(aircraft), lifting_surfaces(again), strict=True):
        assert area(new) == pytest.approx(area(old)) and new.symmetric is old.symmetric
        for values, written in ((old.x_le, new.x_le), (old.y, new.y), (old.z, new.z), (old.chord, new.chord)):
            at = np.interp(new.station, stations(old), values)
            np.testing.assert_allclose(written, at, atol=1e-9)
        for control, written in zip(sorted(old.controls, key=lambda c: c.ends), new.controls, strict=True):
            assert (written.command, written.hinge, written.gain) == (control.command, control.hinge, control.gain)
            ends = np.interp(control.ends, old.station, stations(old))
            np.testing.assert_allclose(written.ends, ends, atol=1e-9)
        np.testing.assert_allclose(mean_line(new.airfoils[0], x)[1], mean_line(old.airfoils[0], x)[1], atol=2e-3)


def stations(surface):
    steps = np.hypot(np.diff(surface.y), np.diff(surface.z))
    return np.concatenate([[0.0], np.cumsum(steps)])


def test_what_avl_does_not_know_is_named(tmp_path):
    with pytest.warns(AvlWarning) as caught:
        write_avl(load_aircraft("hera_like"), tmp_path / "x.avl")
    notes = " ".join(str(w.message) for w in caught)
    assert "fuselage, rotors, section polars, masses" in notes and "strips otherwise on wing" in notes
    with pytest.raises(ValueError, match="no lifting surface"):
        write_avl(load_aircraft("rotor_alone"), tmp_path / "y.avl")


def test_controls_with_a_gap_between_them_do_not_grow_together(tmp_path):
    """AVL joins one variable over neighbouring sections that have it; the second control gets its own."""
    head = 'name = "a"\nflight = { mach = 0.1 }\nreference = { S_m2 = 9.0, c_m = 1.0, b_m = 9.0 }\n'
    row = '[[surface.section]]\nname = "s{0}"\nx_le_m = 0.0\ny_m = {1}\nchord_m = 1.0\n{2}\n'
    rows = [row.format(i, 1.5 * i, "strips = 3" if i < 3 else "") for i in range(4)]
    part = '[[surface.control]]\nname = "e{0}"\ncommand = "delta_e"\ninner = {1}\nouter = {2}\nhinge = 0.7\n'
    parts = [part.format(i, i * 2 / 3, (i * 2 + 1) / 3) for i in range(2)]
    text = "".join([head, '[[surface]]\nname = "w"\n', *rows, *parts])
    aircraft = hera_om.aircraft.loads(text)
    write_avl(aircraft, tmp_path / "x.avl")
    with pytest.warns(AvlWarning, match="elevator, elevator2 all answer to delta_e"):
        again = load_aircraft(tmp_path / "x.avl")
    ends = [c.ends for c in lifting_surfaces(again)[0].controls]
    np.testing.assert_allclose(ends, [(0.0, 1.5), (3.0, 4.5)])


def test_the_loader_takes_an_avl_file_with_overrides(model):
    path = model(name="x.AVL")
    aircraft = quiet(hera_om.load_aircraft, path, {"surface.Main_wing.section.s3.twist_deg": -3.0, "flight.mach": 0.1})
    assert aircraft.surface[0].section[2].twist_deg == -3.0 and aircraft.flight.mach == 0.1


# --- faults

FAULTS = [
    (("0  0  0.0", "-1 0 0.0"), "line 5", "antisymmetric"),
    (("0  0  0.0", "0 1 0.0"), "line 5", "ground"),
    (("YDUPLICATE\n0.0", "YDUPLICATE\n0.5"), "line 15", "about y = 0"),
    (("COMPONENT\n1", "NOWAKE"), "line 13", "no NOWAKE"),
    (("COMPONENT\n1", "NOALBE"), "line 13", "no NOALBE"),
    (("COMPONENT\n1", "NOLOAD"), "line 13", "no NOLOAD"),
    (("COMPONENT", "KOMPONENT"), "line 13", "a keyword of AVL"),
    (("8  1.0  12  1.0", "eight"), "line 12", "Nchord Cspace"),
    (("8  1.0  12  1.0", "8 4.0 12 1.0"), "line 10", "from -3 to 3"),
    (("8  1.0  12  1.0", "8 1.0 1 1.0"), "line 10", "more strips"),
    (("8  1.0  12  1.0", "8 1.0"), "line 23", "Nspan of the section"),
    (("0.1 5.0 0.3  0.4 -2.0", "0.1 5.0"), "line 44", "Xle Yle Zle chord Ainc"),
    (("0.1 5.0 0.3  0.4 -2.0", "0.1 2.0 0.0 0.4 -2.0"), "surface.Main_wing.section.s3.y_m", "zero width"),
    (("0.1 5.0 0.3  0.4 -2.0", "0.1 5.0 0.3 0.0 -2.0"), "surface.Main_wing.section.s3.chord_m", "> 0"),
    (("0.0 2.0 0.0  0.7", "0.0 -2.0 0.0 0.7"), "surface.Main_wing.section.s2.y_m", ">= 0"),
    (("flap 1.0 0.75", "flap 1.0 -0.75"), "line 28", "ahead of a hinge line"),
    (("flap 1.0 0.75", "flap 1.0 1.75"), "line 28", "less than 1"),
    (("flap 1.0 0.75 0. 0. 0. 1", "flap"), "line 28", "XYZhvec"),
    (("NACA\n2412", "NACA\n24x"), "surface.Main_wing.section.s1.airfoil", "4- or 5-digit"),
    (("NACA\n2412", "NACA 0.2 0.8\n2412"), "line 25", "whole chord"),
    (("tip.dat", "gone.dat"), "line 46", "no such file"),
    (("0.5 0.06\n0.2 0.06\n", ""), "line 31", "coordinates"),
    (("0.25\n0  0", "1.25\n0  0"), "flight.mach", "< 1"),
]  # fmt: skip


@pytest.mark.parametrize(("change", "key", "expected"), FAULTS, ids=[f"{f[1]}-{f[2]}" for f in FAULTS])
def test_a_fault_of_a_file_is_named(model, change, key, expected):
    path = model(change)
    with pytest.raises(InputError) as caught:
        quiet(read_avl, path)
    error = caught.value
    assert [p for p in error.problems if p.key == key and expected in p.expected], str(error)
    assert all(p.file == str(path) for p in error.problems)


@pytest.mark.parametrize("cut", [0, 1, 3, 6, 10, 22, 31])
def test_a_file_that_ends_early_is_named(model, cut):
    path = model()
    path.write_text("\n".join(path.read_text().splitlines()[:cut]))
    with pytest.raises(InputError):
        quiet(read_avl, path)


@settings(max_examples=60)
@given(
    place=st.integers(0, 82),
    line=st.one_of(
        st.sampled_from("SURFACE SECTION CONTROL AIRFOIL NACA BODY nan 1e999 0,0,0 -1,-1,-1,-1,-1".split()),
        st.text(max_size=12),
    ),
    insert=st.booleans(),
)
def test_a_damaged_file_is_refused_or_read_never_another_error(place, line, insert):
    lines = TEXT.format(points=POINTS).replace("AFILE\ntip.dat\n", "").splitlines()
    lines[place : place if insert else place + 1] = [line]
    try:
        tables = quiet(avl_tables, "\n".join(lines), "x.avl")
    except InputError:
        return
    assert tables["surface"]
