"""Figures: what they draw, that nothing overlaps or is cut off, and that no state is left behind."""

import itertools
import subprocess
import sys
from dataclasses import replace

import matplotlib
import numpy as np
import pytest
from matplotlib.text import Text

from hera_om import post
from hera_om.aircraft import load_aircraft
from hera_om.post import style
from hera_om.post.figures_shape import fuselage_outline
from hera_om.studies.record import Record

PLOTS = [n for n in post.__all__ if n.startswith("plot_")]


def texts(figure):
    """All visible texts of a figure."""
    figure.draw_without_rendering()
    found = (t for t in figure.findobj(Text) if t.get_visible() and t.get_text().strip())
    return [(t.get_text(), Text.get_window_extent(t)) for t in found]  # without an annotation's arrow


def words(figure):
    """All texts, one string."""
    return " | ".join(text for text, _ in texts(figure))


@pytest.fixture(scope="module")
def infeasible(tmp_path_factory, synthetic):
    """A run that ended infeasible, with two failed evaluations."""
    path = tmp_path_factory.mktemp("bad") / "bad.db"
    after = synthetic.after | {"omega_sp": 2.0}
    aircraft = load_aircraft("hera_like")
    with Record(
        path, kind="mdo", aircraft=aircraft, constraints=synthetic.constraints, objective=synthetic.objective
    ) as r:
        r.snapshot(
            "baseline",
            {"values": synthetic.before | synthetic.start, "arrays": synthetic.arrays(synthetic.start)},
        )
        for i in range(1, 9):
            r.history(synthetic.row(i, i / 8) if i not in (3, 4) else {"iteration": i, "success": False})
        r.snapshot("optimum", {"values": after | synthetic.end, "arrays": synthetic.arrays(synthetic.end)})
    return path


@pytest.mark.parametrize("name", PLOTS)
@pytest.mark.parametrize("which", ["database", "infeasible"])
def test_texts_are_inside_and_clear_of_each_other(name, which, request):
    figure = getattr(post, name)(request.getfixturevalue(which))
    width, height = figure.get_size_inches() * figure.dpi
    found = texts(figure)
    ticks = {t for axes in figure.axes for axis in (axes.xaxis, axes.yaxis) for t in _hidden(axis)}
    seen = [(text, box) for text, box in found if text not in ticks]
    for text, box in seen:
        assert box.x0 > -1 and box.y0 > -1 and box.x1 < width + 1 and box.y1 < height + 1, text
    for (a, box_a), (b, box_b) in itertools.combinations(seen, 2):
        shrunk = box_a.padded(-1.0)
        assert not shrunk.overlaps(box_b.padded(-1.0)), (a, b)


def _hidden(axis):
    """Labels of ticks outside the limits, which matplotlib keeps but does not draw."""
    low, high = sorted(axis.get_view_interval())
    return {t.label1.get_text() for t in axis.get_major_ticks() if not low - 1e-9 <= t.get_loc() <= high + 1e-9}


@pytest.mark.parametrize("name", PLOTS)
def test_every_axis_with_numbers_has_a_label_with_its_unit(name, database):
    figure = getattr(post, name)(database)
    for axes in figure.axes:
        for axis in (axes.xaxis, axes.yaxis):
            label = axis.get_label().get_text()
            named = any(any(c.isalpha() for c in t.get_text()) for t in axis.get_ticklabels())
            if not named and any(t.get_text() for t in axis.get_ticklabels()) and label:
                assert "[" in label or "evaluation" in label, label


def test_history_tells_feasible_from_violated_and_failed(infeasible, database):
    assert "analysis failed" in words(post.plot_history(infeasible))
    figure = post.plot_history(database)
    assert "analysis failed" not in words(figure)
    lines = {line.get_label(): line for line in figure.axes[0].lines}
    assert list(lines["feasible"].get_xdata()) == [11, 12]
    assert len(lines["violates a constraint"].get_xdata()) == 10
    assert all(name in words(figure) for name in ("y_kink", "A_stringer_root", "range_fixed_mass [km]"))


def test_a_violated_constraint_is_red_and_says_so(infeasible, database):
    figure = post.plot_constraints(infeasible)
    bars = {round(p.get_y() + 0.25): p for p in figure.axes[0].patches}
    assert matplotlib.colors.to_hex(bars[1].get_facecolor()).upper() == style.VIOLATED
    assert bars[1].get_width() == pytest.approx(100 * (2.0 - 2.3) / 2.3)
    assert matplotlib.colors.to_hex(bars[0].get_facecolor()).upper() == style.OPTIMUM
    assert "2.3 ≤ 2.000 ≤ 3.5 rad/s, violated by 13 %" in words(figure)
    assert "violated" not in words(post.plot_constraints(database)).replace("| violated", "")


def test_planform_has_the_baseline_to_port_and_the_optimum_to_starboard(database, synthetic):
    axes = post.plot_planform(database).axes[0]
    disks = [line.get_xdata() for line in axes.lines if line.get_linewidth() == 3.2]
    inner = sorted(float(np.mean(x)) for x in disks)
    y0, y1 = synthetic.start["y_prop"], synthetic.end["y_prop"]
    assert inner == pytest.approx([-y0 - 2.75, -y0, -4.1, 4.1, y1, y1 + 2.75])
    assert axes.get_ylim()[0] > axes.get_ylim()[1]  # the nose is up


def test_pressure_is_shown_from_above_without_fins(database):
    """A wing of two panels, one of a fin: four panels are drawn, the optimum to starboard; without any, a note."""
    assert "no snapshot with pressures" in words(post.plot_pressure(database))
    flat = [[[0.0, 0.0, 0.0], [0.0, 2.0, 0.0]], [[1.0, 0.0, 0.0], [1.0, 2.0, 0.0]], [[2.0, 0.0, 0.0], [2.0, 2.0, 0.0]]]
    fin = [[[5.0, 0.0, 0.0], [5.0, 0.0, 2.0]], [[6.0, 0.0, 0.0], [6.0, 0.0, 2.0]]]

    def shot(first):
        surfaces = [
            {"name": "wing", "corners": flat, "pressure": [[first], [0.5]]},
            {"name": "vtail", "corners": fin, "pressure": [[0.0]]},
        ]
        return replace(run.optimum, arrays={"pressure": surfaces})

    run = post.read(database)
    axes, _ = post.plot_pressure(replace(run, baseline=shot(1.0), optimum=shot(2.0))).axes
    port, starboard = axes.collections
    assert port.get_array().tolist() == [1.0, 0.5] and starboard.get_array().tolist() == [2.0, 0.5]
    assert port.get_paths()[0].vertices[:, 0].min() == -2.0 and starboard.get_paths()[1].vertices[:, 1].max() == 2.0


def test_span_load_is_cl_times_chord(database, synthetic):
    upper, lower = post.plot_span_load(database).axes
    shot = synthetic.arrays(synthetic.end)
    found = {line.get_label(): line.get_ydata() for line in upper.lines}
    assert np.allclose(found["optimum, with rotors"], shot["cl_span"])
    assert np.allclose(found["optimum, slipstream off"], shot["cl_span_off"])
    found = {line.get_label(): line.get_ydata() for line in lower.lines}
    assert np.allclose(found["optimum, with rotors"], shot["cl_span"] * shot["chord_span"])


def test_thumbprint_path_and_limits(database, synthetic):
    whole, _ = post.plot_thumbprint(database).axes
    path = next(line for line in whole.lines if line.get_label() == "path")
    assert (path.get_xdata()[0], path.get_ydata()[0]) == (0.61, 2.12)
    assert (path.get_xdata()[-1], path.get_ydata()[-1]) == (0.68, 2.30)
    assert len(path.get_xdata()) == 14 and whole.get_xscale() == "log"
    box = next(p for p in whole.patches if p.get_label() == "Table 7 of the paper")
    assert box.get_bbox().extents == pytest.approx([0.2, 2.3, 1.4, 3.5])
    mil = [line for line in whole.lines if line.get_linestyle() == "--"]
    levels = sorted({y for line in mil for y in line.get_ydata()})
    slope = 2.30**2 / synthetic.after["CAP"]  # n/alpha of the optimum
    assert levels == pytest.approx([np.sqrt(0.085 * slope), np.sqrt(3.6 * slope)])
    assert sorted({x for line in mil for x in line.get_xdata()}) == [0.3, 2.0]


def test_gain_bars_end_at_the_whole_change(database):
    axes = post.plot_gain(database).axes[0]
    assert axes.patches[-1].get_width() == pytest.approx(178.0)
    assert "1\u2009218 → 1\u2009396 km (+14.6 %)" in axes.get_title(loc="left")


def test_box_in_millimetres_against_the_required_reserve(database, synthetic):
    upper, lower = post.plot_box(database).axes
    t = 1e3 * synthetic.arrays(synthetic.end)["box"]["t_skin_upper"]
    assert any(np.allclose(line.get_ydata(), t) for line in upper.lines)
    assert any(list(line.get_ydata()) == [1.5, 1.5] for line in lower.lines)


@pytest.mark.parametrize("name", PLOTS)
def test_an_empty_run_gives_a_figure_that_says_why(name, synthetic, tmp_path):
    figure = getattr(post, name)(synthetic.write(tmp_path / "a.db", until="head"))
    assert not figure.axes and len(words(figure)) > 15


def test_one_design_alone_is_drawn(synthetic, tmp_path):
    path = synthetic.write(tmp_path / "a.db", until="history")
    for name in PLOTS:
        assert "optimum" not in words(getattr(post, name)(path)) or name == "plot_gain"


def test_fuselage_sketch_has_its_width_and_ends_in_points():
    body = load_aircraft("hera_like").fuselage
    x, half = fuselage_outline(body)
    assert x[0] == 0.0 and x[-1] == pytest.approx(body.length_m)
    assert half[0] == half[-1] == 0.0 and half.max() == pytest.approx(body.width_m / 2)


def test_a_notebook_shows_a_figure(database):
    assert post.plot_drag(database)._repr_png_().startswith(b"\x89PNG")


def test_matplotlib_is_left_as_it_was(database):
    before = dict(matplotlib.rcParams)
    post.plot_drag(database)
    assert dict(matplotlib.rcParams) == before


def test_nothing_heavy_is_imported_before_it_is_needed_and_no_pyplot_at_all(root, database):
    code = (
        "import sys, hera_om.post as post; heavy = {'pandas', 'matplotlib', 'openmdao', 'jax'};"
        "print(sorted(heavy & set(sys.modules))); post.plot_drag(sys.argv[1]);"
        "print('matplotlib.pyplot' in sys.modules, 'openmdao' in sys.modules, 'jax' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code, database], cwd=root, capture_output=True, text=True, check=True)
    assert done.stdout.split("\n")[:2] == ["[]", "False False False"]


def test_names_are_public_and_nothing_else_is():
    assert set(post.__all__) <= set(dir(post)) and all(callable(getattr(post, n)) for n in post.__all__)
    with pytest.raises(AttributeError, match="no attribute 'plot_nothing'"):
        _ = post.plot_nothing


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.0, "0"), (1218.4, "1\u2009218"), (-0.5, "−0.5000"), (3.65e6, "3\u2009650\u2009000"),
     (0.000123456, "0.0001235"),
     (1.5e-9, "1.500e−09"), (float("nan"), "–"), (None, "–"), (99.996, "100.0"), (5.0, "5.000")],
)  # fmt: skip
def test_numbers_for_people(value, text):
    assert style.number(value) == text


@pytest.mark.parametrize(
    ("wanted", "places"),
    [
        ([0.1, 0.5], [0.1, 0.5]),
        ([0.5, 0.5, 0.5], [0.5, 0.6, 0.7]),
        ([0.95, 1.0, 1.0], [0.8, 0.9, 1.0]),
        ([], []),
    ],
)
def test_labels_are_spread(wanted, places):
    assert style._spread(wanted, 0.1) == pytest.approx(places)
