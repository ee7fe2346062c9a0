"""Polar tables of a definition: files, faults, NeuralFoil, and what is left in the definition."""

import sys
import types

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from hera_om.aircraft.polar_data import mach_numbers, neuralfoil_table, polar_arrays
from hera_om.aircraft.polars import BladePolarTable, NeuralFoil, PolarTable, load_polar_tables
from hera_om.core.errors import InputError

HEAD = "alpha_deg,reynolds,mach,cl,cd"
ALPHA, REYNOLDS, MACH = (-8.0, -2.0, 2.0, 6.0, 10.0), (1e6, 5e6), (0.0, 0.4)
POINTS = [(a, r, m, 0.1 * (a + 1), 0.006 + 1e-4 * a**2) for a in ALPHA for r in REYNOLDS for m in MACH]


def table(points=POINTS, head=HEAD):
    return "\n".join([head, *(",".join(f"{v!r}" for v in p) for p in points)]) + "\n"


def faults(text):
    with pytest.raises(InputError) as caught:
        polar_arrays(text, "p.csv")
    assert all(p.file == "p.csv" for p in caught.value.problems)
    return "\n".join(str(p) for p in caught.value.problems)


def test_tensor_grid():
    arrays = polar_arrays(table())
    np.testing.assert_array_equal(arrays.alpha_deg, ALPHA)
    np.testing.assert_array_equal(arrays.reynolds, REYNOLDS)
    np.testing.assert_array_equal(arrays.mach, MACH)
    assert arrays.cl.shape == (5, 2, 2)
    np.testing.assert_allclose(arrays.cl[3], 0.7)
    np.testing.assert_allclose(arrays.cd[0], 0.006 + 64e-4)
    np.testing.assert_array_equal(arrays.cm, 0.0)


@given(order=st.permutations(range(len(POINTS))))
def test_rows_in_any_order_columns_too_with_comments(order):
    shuffled = "# NACA something\n" + table([POINTS[i] for i in order])
    for got, expected in zip(polar_arrays(shuffled), polar_arrays(table()), strict=True):
        np.testing.assert_array_equal(got, expected)
    columns = table([(p[4], p[3], 0.02, *p[:3]) for p in POINTS], "cd, cl, cm, alpha_deg, reynolds, mach")
    np.testing.assert_array_equal(polar_arrays(columns).cm, 0.02)


def replaced(index, column, value):
    return [tuple(value if (i, j) == (index, column) else v for j, v in enumerate(p)) for i, p in enumerate(POINTS)]


FAULTS = {
    "empty": ("", "header"),
    "no header": (table(head="1,2,3,4,5"), "header"),
    "misspelt": (table(head="alpha,reynolds,mach,cl,cd"), "header"),
    "twice": (table(head="alpha_deg,reynolds,mach,cl,cl"), "header"),
    "few": (table(POINTS[:3]), "at least 4 lines"),
    "few incidences": (table([p for p in POINTS if p[0] < 6]), "at least 4 incidences"),
    "gap": (table(POINTS[:5] + POINTS[6:]), "point alpha_deg = -2, reynolds = 1e+06, mach = 0.4: got 'missing'"),
    "repeated": (table([*POINTS, POINTS[0]]), "point alpha_deg = -8, reynolds = 1e+06, mach = 0: got 'repeated'"),
    "nan": (table(replaced(2, 3, float("nan"))), "line 4"),
    "inf": (table(replaced(2, 4, float("inf"))), "line 4"),
    "word": (table().replace("0.3", "a lot", 1), "5 finite numbers"),
    "short line": (table() + "1,2\n", "line 22"),
    "negative drag": (table(replaced(7, 4, -0.001)), "drag coefficients above 0"),
    "supersonic": (table([(*p[:2], p[2] + 1.0, *p[3:]) for p in POINTS]), "below 1"),
    "negative Reynolds": (table([(p[0], -p[1], *p[2:]) for p in POINTS]), "Reynolds numbers of at least"),
    "radians upside down": (table([(10 * p[0], *p[1:]) for p in POINTS]), "-60 to 60"),
    "no zero lift": (table([(*p[:3], p[3] + 2.0, p[4]) for p in POINTS]), "lift that rises through zero"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_fault(name):
    text, expected = FAULTS[name]
    assert expected in faults(text)


def test_scattered_points_do_not_fill_the_memory():
    points = [(i / 100 - 5, 1e6 + i, i / 2000, 0.1, 0.01) for i in range(1000)]
    assert "got 'missing'" in faults(table(points))


@settings(suppress_health_check=[HealthCheck.too_slow])
@given(text=st.text(alphabet="0123456789.,-\neE#nai \"'", max_size=80), head=st.sampled_from([HEAD + "\n", ""]))
def test_never_another_error(text, head):
    try:
        polar_arrays(head + text)
    except InputError as error:
        assert error.problems


def test_file_is_copied_into_the_definition(tmp_path):
    (tmp_path / "wing.csv").write_text(table())
    data = {
        "wing": {"polar_table": {"file": "wing.csv"}},
        "surface": [{"name": "fin", "polar_table": {"csv": table()}}],
    }
    assert load_polar_tables(data, tmp_path, "a.toml") == []
    got = PolarTable.model_validate(data["wing"]["polar_table"])
    assert (got.file, got.csv, got.source) == (None, table(), "file wing.csv")
    assert hash(got) == hash(PolarTable(csv=table(), source="file wing.csv"))
    assert data["surface"][0]["polar_table"] == {"csv": table()}
    # loaded again, from no folder at all, nothing changes
    assert load_polar_tables(data, None, "a.toml") == []
    assert data["wing"]["polar_table"] == {"csv": table(), "source": "file wing.csv"}


def test_faults_of_all_tables_at_once_and_by_path(tmp_path):
    (tmp_path / "bad.csv").write_text(table(POINTS[1:]))
    (tmp_path / "binary.csv").write_bytes(b"\xff\xfe\x00")
    data = {
        "wing": {"polar_table": {"file": "none.csv"}},
        "htail": {"polar_table": {}},
        "surface": [
            {"name": "fin", "polar_table": {"file": "bad.csv"}},
            {"name": "canard", "polar_table": {"file": "binary.csv"}},
            {"name": "third", "polar_table": {"file": "bad.csv", "csv": "x"}},
            {"name": "other", "polar_table": {"csv": HEAD}},
        ],
    }
    problems = load_polar_tables(data, tmp_path, "a.toml")
    text = [str(p) for p in problems]
    assert len(text) == 6
    assert text[0].startswith(
        "a.toml: wing.polar_table.file: got 'none.csv', expected a CSV file that can be read (No such"
    )
    assert text[1].startswith("a.toml: htail.polar_table: got nothing, expected one of file, neuralfoil and csv")
    assert text[2].startswith("bad.csv: point alpha_deg = -8")
    assert "canard.polar_table.file" in text[3] and "UTF-8" in text[3]
    assert "third.polar_table: got 'file, csv'" in text[4]
    assert text[5].startswith("a.toml: surface.other.polar_table.csv: rows")
    assert "polar_table" not in data["wing"]


def test_what_is_no_table_is_left_to_the_schema():
    data = {"wing": {"polar_table": 3}, "htail": {"polar_table": {"csv": 3}}}
    assert load_polar_tables(data, None, "a.toml") == []
    assert data["wing"]["polar_table"] == 3


def test_neuralfoil_missing_or_misspelt(monkeypatch):
    monkeypatch.setitem(sys.modules, "aerosandbox", None)
    data = {"wing": {"polar_table": {"neuralfoil": {"airfoil": "naca2412"}}}}
    (problem,) = load_polar_tables(data, None, "a.toml")
    assert problem.key == "wing.polar_table.neuralfoil" and "pip install 'hera-om[neuralfoil]'" in problem.expected
    data = {"wing": {"polar_table": {"neuralfoil": {"airfoil": "naca2412", "alpha": 3.0, "n_crit": 99.0}}}}
    keys = {p.key for p in load_polar_tables(data, None, "a.toml")}
    assert keys == {"wing.polar_table.neuralfoil.alpha", "wing.polar_table.neuralfoil.n_crit"}


def fake_neuralfoil(monkeypatch):
    """Stand-ins that answer with a thin section."""

    def answer(section, *, alpha, Re, n_crit, model_size):
        assert n_crit == 7.0 and model_size == "large"
        return {"CL": 0.11 * (alpha + 2.0), "CD": 0.006 + 0.0 * alpha * Re, "CM": np.array([-0.05])}

    def airfoil(name):
        return types.SimpleNamespace(coordinates=None if name == "clark" else [0])

    monkeypatch.setitem(sys.modules, "aerosandbox", types.SimpleNamespace(Airfoil=airfoil))
    monkeypatch.setitem(sys.modules, "neuralfoil", types.SimpleNamespace(get_aero_from_airfoil=answer))


def test_neuralfoil_through_the_loader(monkeypatch):
    fake_neuralfoil(monkeypatch)
    wanted = {"airfoil": "NACA 2412", "reynolds": [1e6, 4e6], "n_crit": 7.0, "model": "large", "alpha_step_deg": 2.0}
    data = {"wing": {"polar_table": {"neuralfoil": wanted}}}
    assert load_polar_tables(data, None, "a.toml") == []
    arrays = polar_arrays(data["wing"]["polar_table"]["csv"])
    assert arrays.cl.shape == (19, 2, 1) and arrays.alpha_deg[0] == -16.0 and arrays.alpha_deg[-1] == 20.0
    np.testing.assert_allclose(arrays.cm, -0.05)
    data = {"wing": {"polar_table": {"neuralfoil": {**wanted, "airfoil": "clark"}}}}
    (problem,) = load_polar_tables(data, None, "a.toml")
    assert problem.key == "wing.polar_table.neuralfoil.airfoil"


def test_neuralfoil_itself():
    pytest.importorskip("neuralfoil")
    arrays = polar_arrays(neuralfoil_table(NeuralFoil(airfoil="naca2412", reynolds=(3e6, 9e6), model="large")))
    # Abbott and von Doenhoff, Theory of Wing Sections, appendix IV, NACA 2412, smooth: alpha_L0 about -2 deg,
    # cd_min 0.0061 at Re 3.1e6 (0.0058 at 8.9e6), cl_max 1.7 (XFOIL and its kin: up to 16 % more), cm -0.045
    zero = np.interp(0.0, arrays.cl[12:18, 0, 0], arrays.alpha_deg[12:18])
    assert abs(zero + 2.1) < 0.3
    assert 0.0048 < arrays.cd[:, 0, 0].min() < 0.0066
    assert 1.45 < arrays.cl[:, 1, 0].max() < 2.0
    np.testing.assert_allclose(arrays.cm[16, 0, 0], -0.05, atol=0.012)


# --- blades


def blade_data(**polar_table):
    stations = {"r": [0.2, 0.7, 0.8, 1.0], "c": [0.1, 0.22, 0.18, 0.1]}
    return {"blade": [{"name": "b", **stations, "polar_table": polar_table}]}


def test_table_of_a_blade_is_copied_with_its_aspect_ratio(tmp_path, monkeypatch):
    """R/c at 75 % of the radius, once; a table over full incidence needs none."""
    fake_neuralfoil(monkeypatch)
    (tmp_path / "b.csv").write_text(table())
    wanted = {"airfoil": "clarky", "n_crit": 7.0, "model": "large", "alpha_step_deg": 4.0}
    for raw in ({"file": "b.csv"}, {"neuralfoil": wanted}, {"csv": table()}):
        data = blade_data(**raw)
        assert load_polar_tables(data, tmp_path, "a.toml") == []
        got = BladePolarTable.model_validate(data["blade"][0]["polar_table"])
        assert got.aspect_ratio == pytest.approx(5.0) and got.extend and got.compressible
        assert got.csv and (got.file, got.neuralfoil) == (None, None)
        data["blade"][0]["c"] = [0.2] * 4
        assert load_polar_tables(data, None, "a.toml") == []
        assert BladePolarTable.model_validate(data["blade"][0]["polar_table"]) == got
    full = table([(a, 1e6, 0.0, float(np.sin(np.radians(a))), 0.1) for a in (-180.0, -90.0, 0.0, 90.0, 180.0)])
    data = blade_data(csv=full, extend=False)
    assert load_polar_tables(data, None, "a.toml") == []
    assert "aspect_ratio" not in data["blade"][0]["polar_table"]


def test_mach_numbers_of_a_table_of_a_blade():
    one = table([p for p in POINTS if p[2] == 0.0])
    assert mach_numbers(one, True) == (0.0, 0.2, 0.4, 0.5, 0.6, 0.7)
    assert mach_numbers(one, False) == (0.0,) and mach_numbers(table(), True) == MACH


def test_faulty_table_of_a_blade_is_emptied_and_reported_once():
    for raw, said in (
        ({"csv": table(), "extend": False}, "a.toml: blade.b.polar_table.extend: got False, expected true, or a table"),
        ({"csv": table(POINTS[1:])}, "a.toml: blade.b.polar_table.csv: point alpha_deg = -8"),
        ({}, "a.toml: blade.b.polar_table: got nothing, expected one of file, neuralfoil and csv"),
    ):
        data = blade_data(**raw)
        (problem,) = load_polar_tables(data, None, "a.toml")
        assert str(problem).startswith(said)
        assert data["blade"][0]["polar_table"] == {}
    for stations in (None, ["a"], [[1.0]], [float("nan")] * 4):  # what the schema will refuse
        data = blade_data(csv=table())
        data["blade"][0]["c"] = stations
        assert load_polar_tables(data, None, "a.toml") == []
        assert "aspect_ratio" not in data["blade"][0]["polar_table"]
