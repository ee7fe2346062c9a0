"""Differences of a whole problem, against which totals are held."""

import numpy as np
import pytest


@pytest.fixture(scope="session")
def check_totals():
    """Totals of a problem against Richardson's differences, relative to the largest entry of the output's row.

    The rows are scaled by the steps of the variables, so that metres and degrees stand side by side.
    """

    def check(problem, of, steps, tol=1e-5):
        totals = problem.compute_totals(of, list(steps))
        found = np.array([[totals[o, w].item() * h for w, h in steps.items()] for o in of])
        expected = np.zeros_like(found)
        for j, (name, step) in enumerate(steps.items()):
            start, ends = problem.get_val(name).item(), []
            for side in (1.0, -1.0, 0.5, -0.5):
                problem.set_val(name, start + side * step)
                problem.run_model()
                ends.append(np.array([problem.get_val(o).item() for o in of]))
            problem.set_val(name, start)
            expected[:, j] = (8.0 * (ends[2] - ends[3]) - (ends[0] - ends[1])) / 6.0
        problem.run_model()
        error = np.max(np.abs(found - expected), axis=1) / np.max(np.abs(expected), axis=1)
        assert np.all(error < tol), dict(zip(of, error, strict=True))

    return check
