"""Training of a set: choice, quality, determinism, and samples that cannot be trained on."""

import numpy as np
import pytest

from hera_om import surrogates
from hera_om.core.errors import AnalysisFailure, InputError
from hera_om.surrogates import kriging


def test_small_discipline_meets_the_thresholds(small):
    assert small.shortfalls() == {}
    assert small.kinds[2] == "constant"
    for name in ("CD", "Cm", "CT", "cl_span"):
        assert small.chosen(name).r2 > 0.9999


def test_prediction_on_fresh_points_is_as_good_as_the_record_says(small, case):
    """Points that neither the training nor the choice has seen."""
    from_plan = surrogates.latin_hypercube(50, small.lower, small.upper, 77)
    fresh = case(x_test=from_plan)["x_test"]
    alpha, delta = np.deg2rad(fresh.T)
    moment = 0.05 - 1.1 * alpha - 1.5 * delta + alpha**2
    predicted = np.asarray(small.evaluate_many(fresh))[:, small.slices["Cm"]][:, 0]
    assert np.sqrt(np.mean((predicted - moment) ** 2)) < 3 * small.chosen("Cm").rmse_units


def test_better_model_of_each_output_is_used(small):
    for kind, models in zip(small.kinds, small.quality, strict=True):
        assert models[kind].rmse == min(quality.rmse for quality in models.values())
    rows = small.table()
    assert [row["output"] for row in rows if row["chosen"]] == list(small.output_names)
    assert len(rows) == 9 and all(row["meets"] for row in rows if row["chosen"])


def test_each_kind_wins_somewhere(small):
    assert set(small.kinds) == {"kriging", "rbf", "constant"}
    assert small.kinds[small.output_names.index("CT")] == "kriging"


def test_recorded_quality_is_that_of_the_prediction(small):
    """The table was measured before the set was assembled of the chosen models, with modes and units."""
    predicted = np.asarray(small.evaluate_many(small.samples.x_test))
    for name, where in small.slices.items():
        error = predicted[:, where] - small.samples.y_test[:, where]
        assert np.sqrt(np.mean(error**2)) == pytest.approx(small.chosen(name).rmse_units, rel=1e-5, abs=1e-12)


def test_same_seed_gives_the_same_arrays(small, case):
    again = surrogates.train(**case())
    for model in ("kriging", "rbf"):
        mine, theirs = getattr(small.predictor, model), getattr(again.predictor, model)
        assert all(np.array_equal(a, b) for a, b in zip(mine, theirs, strict=True))
    assert again.table() == small.table()


def test_unseen_points_decide_only_the_choice(small, case):
    """Spoilt unseen values change the errors, not one array of a model that is kept."""
    y_test = case()["y_test"]
    y_test[:, 1] *= 1.01
    other = surrogates.train(**case(y_test=y_test))
    assert other.chosen("Cm").rmse > 10 * small.chosen("Cm").rmse
    x = np.array([2.0, 3.0])
    kept = [i for i, name in enumerate(small.output_names) if other.kinds[i] == small.kinds[i] and name != "Cm"]
    for i in kept:
        where = small.slices[small.output_names[i]]
        assert np.array_equal(other.evaluate(x)[where], small.evaluate(x)[where])
    assert len(kept) == 4


def test_output_that_cannot_be_learnt_is_named(case):
    noise = np.random.default_rng(0).normal(size=(46, 1))
    given = dict(output_names=("noise",), output_sizes=None, output_units=None)
    bad = surrogates.train(**case(y=noise[:30], y_test=noise[30:], **given))
    assert list(bad.shortfalls()) == ["noise"] and len(bad.shortfalls()["noise"]) == 3


def test_rounding_errors_are_kept_as_a_constant(case):
    y, y_test = case()["y"], case()["y_test"]
    y[:, 2], y_test[:, 2] = 1e-17 * np.random.default_rng(0).normal(size=30), 0.0
    assert surrogates.train(**case(y=y, y_test=y_test)).kinds[2] == "constant"


def test_constant_over_training_that_varies_over_unseen_points_is_a_shortfall(case):
    y_test = case()["y_test"]
    y_test[:, 2] = np.linspace(0, 1, 16)
    assert "CY" in surrogates.train(**case(y_test=y_test)).shortfalls()


def test_repeated_points_are_dropped(small, case):
    twice = case()
    twice["x"], twice["y"] = np.vstack([twice["x"], twice["x"][:4]]), np.vstack([twice["y"], twice["y"][:4]])
    again = surrogates.train(**twice)
    assert np.array_equal(again.samples.x, small.samples.x)
    assert np.array_equal(again.predictor.kriging.weights, small.predictor.kriging.weights)


def test_progress_tells_each_kriging_model(case):
    told = []
    surrogates.train(**case(progress=lambda *step: told.append(step)))
    assert [step[0] for step in told] == list(range(1, len(told) + 1))
    assert told[0] == (1, len(told), "CD") and told[-1][2].startswith("cl_span (mode ")


def test_failure_of_smt_names_the_output(case, monkeypatch):
    def refuse(*arguments):
        raise np.linalg.LinAlgError("not positive definite")

    monkeypatch.setattr(kriging, "fit_smt", refuse)
    with pytest.raises(AnalysisFailure, match="CD: Kriging was not trained: not positive definite"):
        surrogates.train(**case())


def spoil(table, row, column, value):
    def change(arguments):
        arguments[table][row, column] = value

    return change


def replace(**changes):
    return lambda arguments: arguments.update(changes)


def contradict(arguments):
    arguments["x"][9] = arguments["x"][4]


def leak(arguments):
    arguments["x_test"][2] = arguments["x"][11]


def freeze(arguments):
    arguments["x"][:, 1] = 0.0


def shorten(arguments):
    arguments["x"], arguments["y"] = arguments["x"][:5], arguments["y"][:5]


def repeat_few(arguments):
    for key in ("x", "y"):
        arguments[key] = np.repeat(arguments[key][:5], 2, axis=0)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (spoil("y", 12, 0, np.nan), ["y: CD, row 12", "nan"]),
        (spoil("y", 3, 6, np.inf), ["y: cl_span[2], row 3", "inf"]),
        (spoil("x", 7, 1, np.nan), ["x: delta_e, row 7", "nan"]),
        (spoil("y_test", 1, 1, -np.inf), ["y_test: Cm, row 1"]),
        (spoil("x", 2, 0, 11.0), ["x: alpha, row 2", "11.0", "between -4 and 10"]),
        (contradict, ["y: CD, rows 4 and 9"]),
        (leak, ["x_test: row 2", "not trained on"]),
        (freeze, ["x: delta_e", "more than one value"]),
        (shorten, ["x: number of rows: got 5", "at least 6, for 2 inputs"]),
        (repeat_few, ["x: number of rows: got 5", "at least 6"]),
        (replace(x_test=np.zeros((1, 2)), y_test=np.zeros((1, 11))), ["x_test: number of rows: got 1"]),
        (replace(y=np.zeros((29, 11))), ["got 30", "rows of outputs: 29"]),
        (replace(y=np.zeros((30, 9))), ["y: shape: got (30, 9)", "11 columns"]),
        (replace(x=np.zeros(30)), ["x: shape: got (30,)"]),
        (replace(lower=(-4.0,)), ["lower, upper"]),
        (replace(lower=(-4.0,), upper=(10.0,)), ["got 1, expected 2 bounds"]),
        (replace(lower=(-4.0, 30.0)), ["bounds of delta_e"]),
        (replace(output_names=("CD", "CD", "CY", "CT", "cl_span")), ["output_names", "no name twice"]),
        (replace(output_sizes=(1, 1, 1)), ["output_sizes"]),
        (replace(output_sizes=(1, 1, 0, 1, 8)), ["output_sizes"]),
        (replace(input_units=("deg",)), ["units of input_names"]),
    ],
)
def test_samples_that_make_no_sense_are_named(case, change, words):
    arguments = case()
    change(arguments)
    with pytest.raises(InputError) as caught:
        surrogates.train(**arguments)
    for word in words:
        assert word in str(caught.value)


def test_every_bad_number_is_reported(case):
    arguments = case()
    arguments["y"][[3, 8], 0] = np.nan
    arguments["x_test"][0, 0] = 99.0
    with pytest.raises(InputError) as caught:
        surrogates.train(**arguments)
    assert len(caught.value.problems) == 3


def test_caller_keeps_its_arrays(case):
    arguments = case()
    before = {key: arguments[key].copy() for key in ("x", "y", "x_test", "y_test")}
    trained = surrogates.train(**arguments)
    arguments["y"][:] = 0.0
    assert np.array_equal(trained.samples.y, before["y"])
    assert all(np.array_equal(arguments[key], before[key]) for key in ("x", "x_test", "y_test"))
