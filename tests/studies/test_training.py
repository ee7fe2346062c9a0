"""Training of a surrogate, and the surrogate in the place of the lattice."""

import numpy as np
import openmdao.api as om
import pytest

from hera_om.components.aero import Aerodynamics
from hera_om.components.surrogate import SurrogateAerodynamics, derived
from hera_om.core.errors import AnalysisFailure, RecordError
from hera_om.models.cases import table_4
from hera_om.studies import train, trim
from hera_om.studies import training as module
from hera_om.surrogates import load

SAMPLES = 40
STATES = ("alpha", "delta_e", "theta_hybrid", "theta_electric")


@pytest.fixture(scope="module")
def short(small):
    """The aircraft with one variable."""
    return small.model_copy(update={"variables": small.variables[3:4]})


@pytest.fixture(scope="module")
def made(short, tmp_path_factory):
    """A trained surrogate: what the study returned, and what it saved."""
    found = train(short, samples=SAMPLES, seed=3, out=tmp_path_factory.mktemp("train") / "s.npz")
    return found, load(found["path"])


def components(aircraft, surrogates):
    """Lattice and surrogate side by side."""
    out = []
    for component in (Aerodynamics(aircraft=aircraft), SurrogateAerodynamics(aircraft=aircraft, surrogate=surrogates)):
        problem = om.Problem(reports=False)
        problem.model.add_subsystem("aero", component, promotes=["*"])
        problem.setup()
        for name, (low, high) in module.sample_box(aircraft).items():
            if name in ("x_cg", "z_cg"):
                problem.set_val(name, 0.5 * (low + high))
        problem.final_setup()
        out.append((problem, component))
    return out


def test_what_a_training_returns(made, short):
    found, surrogates = made
    assert found["samples"] == SAMPLES and found["unseen"] == 8 and found["failed"] == 0
    assert set(surrogates.input_names) == {"htail_scale", "x_cg", "z_cg", *STATES}
    rows = {r["output"] for r in found["quality"]}
    assert {"CL", "CD", "Cm", "CX", "CZ", "thrust", "Cm_alpha", "cl_span"} <= rows and not rows & set(derived(short))
    assert all({"r2", "re", "rmse", "chosen", "model"} <= set(r) for r in found["quality"])
    best = {r["output"]: r for r in found["quality"] if r["chosen"]}
    for name in ("CL", "Cm", "CZ", "Cm_alpha", "thrust"):
        assert best[name]["r2"] > 0.9, name


def test_the_same_interface_as_the_lattice(made, short):
    (_, lattice), (_, surrogate) = components(short, made[1])
    keys = ("units", "shape")
    assert lattice.get_io_metadata(metadata_keys=keys, return_rel_names=True) == surrogate.get_io_metadata(
        metadata_keys=keys, return_rel_names=True
    )
    assert set(lattice._var_rel_names["input"]) == set(surrogate._var_rel_names["input"])


def test_partials_of_the_surrogate(made, short):
    """To 1e-5 of the largest slope over the box, where rounding leaves differences; the models' tests hold 1e-7."""
    _, (problem, component) = components(short, made[1])
    point = {"alpha": 2.0, "delta_e": 1.0, "load_factor": 1.5, "q_hat": 0.003, "htail_scale": 1.05}
    for name, value in point.items():
        problem.set_val(name, value)
    problem.run_model()
    inputs = {n: np.array(problem.get_val(n)) for n in component._var_rel_names["input"]}
    partials = {}
    component.compute_partials(inputs, partials)
    names = list(component._var_rel_names["output"])

    def outputs(**moved):
        out = {n: np.zeros(component._outputs[n].shape) for n in names}
        component.compute(inputs | moved, out)
        return out

    # The sums behind Kriging leave rounding of 1e-9: steps are 1 % of the box, and each output is judged by its
    # largest slope over the box.
    wide = {n: b - a for n, (a, b) in module.sample_box(short).items()} | {"load_factor": 1.5, "q_hat": 0.01}
    slopes, found = {n: [] for n in names}, {n: [] for n in names}
    for wrt in (*point, "theta_hybrid", "x_cg"):
        step = 0.01 * wide[wrt]
        a, b, c, d = (outputs(**{wrt: inputs[wrt] + h}) for h in (step, -step, step / 2, -step / 2))
        for of in names:
            slopes[of].append(((8 * (c[of] - d[of]) - (a[of] - b[of])) / (6 * step)).ravel() * wide[wrt])
            found[of].append(np.ravel(partials[of, wrt]) * wide[wrt])
    for of in names:
        size = np.max(np.abs(slopes[of]))
        np.testing.assert_allclose(found[of], slopes[of], rtol=0, atol=max(1e-5 * size, 1e-9), err_msg=of)


def test_pull_up_and_derived_outputs(made, short):
    """A pitch rate adds CL_q q; L/D is the ratio of its parts."""
    _, (problem, _) = components(short, made[1])
    problem.run_model()
    level = {n: problem.get_val(n).item() for n in ("CL", "CD", "CL_q", "L_over_D", "speed")}
    assert level["L_over_D"] == pytest.approx(level["CL"] / level["CD"], rel=1e-12)
    problem.set_val("load_factor", 2.5)
    problem.run_model()
    rate = 1.5 * 9.80665 / level["speed"] * 2.4755 / (2 * level["speed"])
    assert problem.get_val("CL").item() == pytest.approx(level["CL"] + level["CL_q"] * rate, rel=1e-12)


@pytest.mark.parametrize(
    ("name", "value", "text"),
    [("alpha", 15.0, r"outside the box.*alpha = 15 not in \[-1, 10\]"), ("mach", 0.3, "holds at mach 0.5 only")],
)
def test_what_it_does_not_know_it_says(made, short, name, value, text):
    _, (problem, _) = components(short, made[1])
    problem.set_val(name, value)
    with pytest.raises(om.AnalysisError, match=text):
        problem.run_model()


def test_the_trim_is_that_of_the_lattice(made, short):
    path = made[0]["path"]
    lattice, surrogate = trim(short), trim(short, aero=path)
    assert surrogate["trimmed"] is True
    for state, tolerance in zip(STATES, (0.3, 0.3, 0.3, 0.3), strict=True):
        assert surrogate["values"][state] == pytest.approx(lattice["values"][state], abs=tolerance), state
    assert surrogate["values"]["CL"] == pytest.approx(lattice["values"]["CL"], rel=0.01)
    best = trim(short, aero=path, method="SLSQP")
    assert best["trimmed"] is True
    for state, (low, high) in table_4(short).items():
        box = dict(zip(made[1].input_names, zip(made[1].lower, made[1].upper, strict=True), strict=True))[state]
        assert max(low, box[0]) - 1e-9 <= best["values"][state] <= min(high, box[1]) + 1e-9


def test_a_surrogate_of_another_aircraft_is_refused(made, short):
    other = short.model_copy(update={"name": "another"})
    with pytest.raises(RecordError, match=r"s\.npz: the surrogate was trained on another definition than 'another'"):
        trim(other, aero=made[0]["path"])


def test_a_seed_decides_everything(short, tmp_path, monkeypatch):
    """Two trainings with one seed are equal, another seed is not; three outputs are enough to see it."""
    few = ("CL", "Cm", "cl_span")
    original = module._analyse

    def some(*args):
        __, y, kept = original(*args)
        return list(few), y[:, : 2 + 8], kept

    monkeypatch.setattr(module, "_analyse", some)
    points = [train(short, samples=20, seed=s, out=tmp_path / f"{i}.npz")["path"] for i, s in enumerate((5, 5, 6))]
    first, again, other = (load(p) for p in points)
    x = 0.5 * (first.lower + first.upper)
    assert np.array_equal(first.evaluate(x), again.evaluate(x))
    assert not np.array_equal(first.evaluate(x), other.evaluate(x))


def test_samples_that_fail_are_left_out_until_there_are_too_many(short, monkeypatch):
    original, calls = Aerodynamics.compute, []

    def compute(self, inputs, outputs):
        calls.append(1)
        if len(calls) % every == 0:
            raise om.AnalysisError("injected")
        original(self, inputs, outputs)

    monkeypatch.setattr(Aerodynamics, "compute", compute)
    every, box = 3, module.sample_box(short)
    x = np.tile([0.5 * (a + b) for a, b in box.values()], (9, 1))
    calls.clear()
    _, y, kept = module._analyse(short, list(box), x, None)
    assert kept.sum() == 6 and np.all(np.isfinite(y[kept])) and np.all(np.isnan(y[~kept]))
    with pytest.raises(AnalysisFailure, match=r"train: \d+ of 12 sample analyses failed"):
        train(short, samples=10, out="unused.npz")
