"""Figures of the interaction: what they show, that texts are inside and clear of each other, files."""

import itertools

import numpy as np
import pytest
from matplotlib.text import Text

from hera_om.post import figures_interaction as figures


@pytest.fixture(scope="module")
def result():
    """Numbers of the right shape."""
    y, alphas, azimuth = np.linspace(0.2, 14.0, 30), (0.0, 5.0), np.arange(0.0, 360.0, 10.0)
    load = np.sqrt(1.0 - (y / 14.5) ** 2)
    curve = {"alpha": [-4.0, 0.0, 5.0], **{k: [-0.1, 0.0, 0.1] for k in ("CX", "CZ", "Cm", "CZ_tail", "Cm_tail")}}
    velocity = np.outer(0.1 * np.sin(y), np.ones(3)).tolist()
    wave = np.radians(azimuth)
    return {
        "curves": {name: curve for name in ("Full without rotors", "Full with rotors", "Fuselage + tail")},
        "span": [
            {"alpha": a, "y": y.tolist()}
            | {f"{k}_{case}": ((1 + a) * load).tolist() for k in ("cz_c", "cx_c") for case in ("on", "off")}
            for a in alphas
        ],
        "leading_edge": [
            {"alpha": a, "y": y.tolist(), **{k: velocity for k in ("both", "wing", "rotors")}} for a in alphas
        ],
        "blades": [
            {"alpha": a, "rotor": name, "azimuth_deg": azimuth.tolist()}
            | {"both": (0.1 + 0.02 * a * np.cos(wave)).tolist(), "rotors": [0.1] * len(azimuth)}
            for a in alphas
            for name in ("hybrid", "electric 1", "electric 2")
        ],
        "disks": [[4.1, 1.95], [8.0, 1.2], [10.75, 1.2]],
    }


CASE = {k: np.linspace(0.1, 1.0, 5) for k in ("J", "CT", "CP", "eta", "J_data", "CT_data", "CP_data", "eta_data")}
PLOTS = {
    "loads": (figures.plot_loads, ("CZ", "Cm", "angle of attack [deg]", "Fuselage + tail")),
    "span": (figures.plot_span, ("cz c [m]", "cx c [m]", "y [m]", "without rotors")),
    "edge": (figures.plot_leading_edge, ("w / V [-]", "u / V [-]", "y [m]", "α = 5°")),
    "blades": (figures.plot_blades, ("azimuth [deg]", "dT/dr", "electric 2", "rotors alone")),
    "propeller": (
        lambda _: figures.plot_propeller([CASE | {"label": "25°"}, CASE | {"label": "35°"}], "a propeller"),
        ("CT [-]", "CP [-]", "efficiency [-]", "advance ratio J", "measured", "35°"),
    ),
}


@pytest.mark.parametrize("name", PLOTS)
def test_texts_are_there_inside_and_apart(name, result):
    draw, expected = PLOTS[name]
    figure = draw(result)
    figure.draw_without_rendering()
    width, height = figure.get_size_inches() * figure.dpi
    labels = [t for t in figure.findobj(Text) if t.get_visible() and t.get_text().strip()]
    words = " | ".join(t.get_text() for t in labels)
    assert all(word in words for word in expected), words
    ticks = {t for a in figure.axes for axis in (a.xaxis, a.yaxis) for t in axis.get_ticklabels()}
    boxes = [(t.get_text(), t.get_window_extent()) for t in labels if t not in ticks]
    for text, box in boxes:
        assert box.x0 >= -1 and box.y0 >= -1 and box.x1 <= width + 1 and box.y1 <= height + 1, text
    for (a, one), (b, other) in itertools.combinations(boxes, 2):
        assert not one.overlaps(other), (a, b)


def test_files_are_pictures(result, tmp_path):
    paths = figures.write_figures(result, tmp_path)
    assert len(paths) == 4 and all(p.read_bytes().startswith(b"\x89PNG") for p in paths)


def test_curves_are_the_numbers(result):
    lines = figures.plot_span(result).axes[0].get_lines()
    np.testing.assert_allclose(lines[2].get_ydata(), result["span"][1]["cz_c_on"])
