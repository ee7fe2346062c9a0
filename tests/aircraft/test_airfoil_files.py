"""Coordinate files: both formats, copied in at load, faults by name."""

import numpy as np
import pytest

from hera_om.aircraft import definition_hash, dumps, lifting_surfaces, load_aircraft, loads
from hera_om.core.errors import InputError

X = (1.0, 0.75, 0.5, 0.25, 0.1, 0.0, 0.1, 0.25, 0.5, 0.75, 1.0)
Z = (0.0, 0.03, 0.06, 0.07, 0.05, 0.0, -0.03, -0.04, -0.03, -0.01, 0.0)
WING = """
name = "w"
[flight]
mach = 0.1
[[wing.section]]
name = "root"
y_m = 0.0
chord_m = 1.0
thickness = 0.12
airfoil = "{0}"
[[wing.section]]
name = "tip"
y_m = 4.0
chord_m = 1.0
thickness = 0.12
airfoil = "{1}"
sweep_quarter_deg = 0.0
dihedral_deg = 0.0
"""


def selig(x=X, z=Z):
    return "some profile\n" + "\n".join(f"{a:.4f}  {b:.4f}" for a, b in zip(x, z, strict=True)) + "\n"


def lednicer():
    top, low = list(zip(X, Z, strict=True))[5::-1], list(zip(X, Z, strict=True))[5:]

    def rows(pairs):
        return "\n".join(f" {a:.4f} {b:.4f}" for a, b in pairs)

    return f"some profile\n {len(top)}.  {len(low)}.\n\n{rows(top)}\n\n{rows(low)}\n"


def write(folder, profile, root="profiles/a.dat", tip="NACA 2412"):
    (folder / "profiles").mkdir(exist_ok=True)
    if profile is not None:
        (folder / "profiles" / "a.dat").write_text(profile)
    path = folder / "w.toml"
    path.write_text(WING.format(root, tip))
    return path


@pytest.mark.parametrize(
    "text", [selig(), lednicer(), selig().split("\n", 1)[1]], ids=["Selig", "Lednicer", "no title"]
)
def test_coordinates_are_copied_in(tmp_path, text):
    aircraft = load_aircraft(write(tmp_path, text))
    assert aircraft.wing.section[0].airfoil == "a" and aircraft.wing.section[1].airfoil == "NACA 2412"
    assert (aircraft.airfoil[0].x, aircraft.airfoil[0].z) == (X, Z)
    assert lifting_surfaces(aircraft)[0].airfoils == ((X, Z), "NACA 2412")
    again = loads(dumps(aircraft))  # without the file
    assert again == aircraft and definition_hash(again) == definition_hash(aircraft)


def test_a_file_that_two_sections_name_is_copied_once(tmp_path):
    aircraft = load_aircraft(write(tmp_path, selig(), tip="profiles/a.dat"))
    assert [a.name for a in aircraft.airfoil] == ["a"]


def test_coordinates_count_in_the_hash(tmp_path):
    first = definition_hash(load_aircraft(write(tmp_path, selig())))
    assert definition_hash(load_aircraft(write(tmp_path, selig(z=(0.001, *Z[1:]))))) != first


@pytest.mark.parametrize(
    ("text", "why"),
    [
        (None, "no such file"),
        ("", "0 points"),
        (selig().replace("0.2500", "abc", 1), "line 5 is no pair of numbers"),
        (selig(X[:3], Z[:3]), "3 points"),
        (selig([100 * x for x in X]), "x runs from 0 to 100"),
        (selig((1.0, 0.2, 0.5, 0.25, 0.1, 0.0, 0.1, 0.25, 0.5, 0.75, 1.0)), "neither rises throughout nor falls"),
        (selig((0.9, *X[1:])), "neither rises"),
        (lednicer().replace(" 6.  6.", " 6.  7."), "6 + 7"),
    ],
)
def test_a_bad_file_is_named_with_the_reason(tmp_path, text, why):
    with pytest.raises(InputError) as caught:
        load_aircraft(write(tmp_path, text))
    (problem,) = caught.value.problems
    assert (problem.key, problem.value) == ("wing.section.root.airfoil", "profiles/a.dat") and why in problem.expected


def test_a_binary_file_and_a_folder_are_named(tmp_path):
    path = write(tmp_path, "")
    (tmp_path / "profiles" / "a.dat").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match="no text"):
        load_aircraft(path)
    (tmp_path / "profiles" / "b.dat").mkdir()
    path.write_text(WING.format("profiles/b.dat", "flat"))
    with pytest.raises(InputError, match="directory"):
        load_aircraft(path)


def test_both_the_file_and_other_faults_are_reported(tmp_path):
    path = write(tmp_path, None)
    path.write_text(path.read_text().replace("mach = 0.1", "mach = 2.0"))
    with pytest.raises(InputError) as caught:
        load_aircraft(path)
    assert {p.key for p in caught.value.problems} == {"wing.section.root.airfoil", "flight.mach"}


def test_own_coordinates_are_checked():
    own = '[[airfoil]]\nname = "mean"\nx = [0.0, 0.25, 0.5, 0.75, 1.0]\nz = [0.0, 0.01, 0.02, 0.01, 0.0]\n'
    assert loads(WING.format("mean", "mean") + own).airfoil[0].z[2] == 0.02
    for old, new, expected in (
        ("0.02, 0.01, 0.0]", "0.02, 0.01, 0.0, 0.0]", "as many as x"),
        ("0.25, 0.5, 0.75", "0.5, 0.25, 0.75", "neither rises"),
        ("z = [0.0", "z = [nan", "finite"),
        ('name = "mean"', 'name = "flat"', "another name"),
    ):
        with pytest.raises(InputError) as caught:
            loads(WING.format("mean", "flat") + own.replace(old, new))
        assert any(expected in p.expected for p in caught.value.problems), str(caught.value)


def test_coordinates_are_structure_not_numbers(tmp_path):
    from hera_om.aircraft import blank, numbers

    aircraft = load_aircraft(write(tmp_path, selig()))
    assert not any(path.startswith("airfoil") for path in numbers(aircraft))
    assert blank(aircraft).airfoil == aircraft.airfoil
    np.testing.assert_array_equal(lifting_surfaces(blank(aircraft))[0].airfoils[0].x, X)
