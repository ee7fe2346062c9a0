"""The derivative check that every component test applies."""

import numpy as np
import pytest


def _run(component, inputs, names):
    """Outputs of a component as plain arrays."""
    outputs = {name: np.zeros(meta["shape"]) for name, meta in component._var_rel2meta.items()}
    component.compute(inputs, outputs)
    return {name: np.ravel(outputs[name]) for name in names}


def _difference(component, inputs, wrt, i, step, names):
    """Central difference of all outputs by one entry of one input."""
    ends = []
    for sign in (1.0, -1.0):
        moved = inputs[wrt].copy()
        moved.flat[i] += sign * step
        ends.append(_run(component, inputs | {wrt: moved}, names))
    return {name: (ends[0][name] - ends[1][name]) / (2.0 * step) for name in names}


@pytest.fixture(scope="session")
def check_partials():
    """Partials of a component against Richardson's differences, relative to the largest entry of their block.

    A block that is smaller than what rounding leaves of the differences counts as zero: ``floor`` times the
    size of the output over the size of the input. ``noise`` names outputs that are nothing but rounding,
    ``least`` is the least error that counts where they are so by design (the moment of a lone rotor), ``steps`` the
    relative steps of single inputs.
    """

    def check(component, inputs, tol=1e-6, relative_step=1e-4, floor=1e-8, noise=(), least=1e-300, steps=None):
        inputs = {name: np.asarray(value, float) for name, value in inputs.items()}
        names = [n for n in component._var_rel_names["output"] if n not in noise]
        assert set(inputs) == set(component._var_rel_names["input"])
        value, partials = _run(component, inputs, names), {}
        component.compute_partials(inputs, partials)
        worst = {}
        for wrt, x in inputs.items():
            size = max(float(np.max(np.abs(x))), 1e-2)
            columns = []
            for i in range(x.size):
                step = (steps or {}).get(wrt, relative_step) * max(abs(float(x.flat[i])), 0.1 * size)
                wide = _difference(component, inputs, wrt, i, step, names)
                narrow = _difference(component, inputs, wrt, i, step / 2.0, names)
                columns.append({n: (4.0 * narrow[n] - wide[n]) / 3.0 for n in names})
            for name in names:
                expected = np.stack([c[name] for c in columns], axis=-1)
                found = np.reshape(partials.get((name, wrt), np.zeros(expected.size)), expected.shape)
                allowed = tol * np.max(np.abs(expected)) + floor * np.max(np.abs(value[name])) / size
                worst[name, wrt] = float(np.max(np.abs(found - expected)) / max(allowed, least))
        bad = {block: f"{ratio:.1e} of what is allowed" for block, ratio in worst.items() if not ratio <= 1.0}
        assert not bad, bad
        assert any(np.any(np.asarray(p) != 0.0) for p in partials.values())

    return check


@pytest.fixture(scope="session")
def ready():
    """A component that has been set up and run, in a problem of its own; inputs by name."""
    import openmdao.api as om

    def make(component, **values):
        problem = om.Problem(reports=False)
        problem.model.add_subsystem("c", component, promotes=["*"])
        problem.setup()
        for name, value in values.items():
            problem.set_val(name, value)
        problem.run_model()
        inputs = {n: np.array(problem.get_val(n)) for n in component._var_rel_names["input"]}
        return problem, inputs

    return make
