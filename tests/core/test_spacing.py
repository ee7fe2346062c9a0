"""Laws of spacing by closed forms."""

import numpy as np
import pytest

from hera_om.core.spacing import chord_points, law_at, law_number


def points(law, n):
    return [law_at(law_number(law), i / n) for i in range(n + 1)]


def test_laws_by_hand():
    half = np.sqrt(0.5)
    np.testing.assert_allclose(points("uniform", 2), [0.0, 0.5, 1.0])
    np.testing.assert_allclose(points("cosine", 4), [0.0, (1 - half) / 2, 0.5, (1 + half) / 2, 1.0], atol=1e-15)
    np.testing.assert_allclose(points("sine", 2), [0.0, half, 1.0], atol=1e-15)
    np.testing.assert_allclose(points("sine-inner", 2), [0.0, 1 - half, 1.0], atol=1e-15)
    np.testing.assert_allclose(points("1.5", 4), np.mean([points("cosine", 4), points("sine-inner", 4)], axis=0))
    with pytest.raises(ValueError, match="random"):
        law_number("random")


def test_panels_along_the_chord():
    """Uniform: quarter points. Cosine: one panel has its vortex and its condition where thin-airfoil theory asks."""
    edges, vortices, conditions = chord_points(0.0, 2)
    np.testing.assert_allclose(edges, [0.0, 0.5, 1.0])
    np.testing.assert_allclose(vortices, [0.125, 0.625])
    np.testing.assert_allclose(conditions, [0.375, 0.875])
    step = np.pi / 22
    edges, vortices, conditions = chord_points(1.0, 5)
    assert edges[0] == 0.0 and edges[-1] == 1.0
    np.testing.assert_allclose(vortices, (1 - np.cos(step * (4 * np.arange(5) + 2))) / 2)
    np.testing.assert_allclose(conditions, (1 - np.cos(step * (4 * np.arange(5) + 4))) / 2)


@pytest.mark.parametrize("law", [0.0, 0.5, 1.0, 1.5, 2.0, 2.5, 3.0, -1.5, -2.0, -2.5])
def test_points_rise(law):
    edges, vortices, conditions = (np.array(v) for v in chord_points(law, 6))
    assert np.all(edges[:-1] < vortices) and np.all(vortices < conditions) and np.all(conditions < edges[1:])
