"""From samples to a set of surrogates: both models of every output, and the better one kept."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import jax
import numpy as np
from jaxtyping import Float
from numpy.typing import ArrayLike

from hera_om.core.errors import InputError, Problem
from hera_om.core.provenance import provenance
from hera_om.surrogates import kriging, pod, rbf
from hera_om.surrogates.domain import bounds_problems, to_unit
from hera_om.surrogates.quality import Quality, measure
from hera_om.surrogates.samples import Samples, is_constant, shape_problems, value_problems, without_twins
from hera_om.surrogates.surrogate_set import Kind, Predictor, SurrogateSet

Progress = Callable[[int, int, str], None]

_kriging_many = jax.jit(jax.vmap(kriging.predict, in_axes=(None, 0)))
_rbf_many = jax.jit(jax.vmap(rbf.predict, in_axes=(None, 0)))


class _Output(NamedTuple):
    """One output on its way: its columns of y and its columns of the scores."""

    name: str
    columns: slice
    scores: slice
    pod: pod.Pod


def train(
    x: ArrayLike,
    y: ArrayLike,
    *,
    input_names: Sequence[str],
    output_names: Sequence[str],
    lower: ArrayLike,
    upper: ArrayLike,
    seed: int,
    x_test: ArrayLike,
    y_test: ArrayLike,
    output_sizes: Sequence[int] | None = None,
    input_units: Sequence[str | None] | None = None,
    output_units: Sequence[str | None] | None = None,
    definition_hash: str = "",
    pod_tolerance: float = pod.TOLERANCE,
    progress: Progress | None = None,
) -> SurrogateSet:
    """Kriging and RBF of every output on scaled inputs, and of the two the better one on unseen points.

    Better means the lower RMSE. Outputs are standardised, and an array output (``output_sizes`` above 1) is
    reduced to its leading modes, all of whose scores use the same kind of model. An output that does not
    vary becomes a constant. The width of the RBF and the parameters of the Kriging come from the training
    points alone; only the choice between the two is made on the unseen points, so the errors of the chosen
    one are a little optimistic.

    Args:
        x: training inputs [n, d], n at least 2 (d + 1).
        y: training outputs [n, sum of output_sizes].
        input_names: d names.
        output_names: names of the outputs.
        lower: lower bounds of the inputs [d].
        upper: upper bounds of the inputs [d].
        seed: seed of everything random in the training; the same seed gives the same arrays.
        x_test: unseen inputs [k, d], k at least 2.
        y_test: outputs there.
        output_sizes: columns of y that belong to each output; 1 each by default.
        input_units: units of the inputs, kept for the record.
        output_units: units of the outputs, likewise.
        definition_hash: hash of the aircraft definition behind the samples, likewise.
        pod_tolerance: what the modes of an array output may leave out, see ``pod.decompose``.
        progress: called with (models done, models, name of the last); Kriging takes the time.

    Returns:
        The trained set.

    Raises:
        InputError: names, shapes, bounds or samples make no sense, every fault with its name and row.
        AnalysisFailure: SMT could not train a model.
    """
    sizes = tuple(output_sizes) if output_sizes is not None else (1,) * len(output_names)
    names = tuple(input_names), tuple(output_names)
    units = (
        tuple(input_units) if input_units is not None else (None,) * len(input_names),
        tuple(output_units) if output_units is not None else (None,) * len(output_names),
    )
    low, high = np.array(lower, dtype=float), np.array(upper, dtype=float)
    _refuse(_name_problems(names, units, sizes) + bounds_problems("surrogate", low, high, names[0]))
    samples = Samples(*(np.array(table, dtype=float) for table in (x, y, x_test, y_test)))
    samples = _checked(samples, names[0], names[1], sizes, low, high)

    unit = to_unit(samples.x, low, high)
    outputs, scores = _reduce(samples.y, names[1], sizes, pod_tolerance)
    labels = [_label(output, j) for output in outputs for j in range(output.pod.modes.shape[1])]
    krg = kriging.train(unit, scores, seed, labels=labels, progress=progress)
    radial = rbf.train(unit, scores, seed)
    unit_test = to_unit(samples.x_test, low, high)
    unseen: dict[Kind, Float[np.ndarray, "k s"]] = {
        "kriging": np.asarray(_kriging_many(krg, unit_test)),
        "rbf": np.asarray(_rbf_many(radial, unit_test)),
    }
    quality = tuple(_judge(output, unseen, samples) for output in outputs)
    kinds: tuple[Kind, ...] = tuple(_better(models) for models in quality)
    return SurrogateSet(
        input_names=names[0],
        input_units=units[0],
        output_names=names[1],
        output_units=units[1],
        output_sizes=sizes,
        kinds=kinds,
        quality=quality,
        predictor=_assemble(outputs, kinds, krg, radial, low, high),
        samples=samples,
        seed=int(seed),
        definition_hash=definition_hash,
        versions=provenance(),
    )


def _refuse(problems: list[Problem]) -> None:
    """Raise what was found."""
    if problems:
        raise InputError(problems)


def _name_problems(
    names: tuple[tuple[str, ...], tuple[str, ...]],
    units: tuple[tuple[str | None, ...], tuple[str | None, ...]],
    sizes: tuple[int, ...],
) -> list[Problem]:
    """Names, units and sizes that do not fit each other."""
    problems = []
    for key, given, unit in zip(("input_names", "output_names"), names, units, strict=True):
        if not given or len(set(given)) != len(given):
            problems.append(Problem("surrogate", key, given, "at least one name, no name twice"))
        if len(unit) != len(given):
            problems.append(Problem("surrogate", f"units of {key}", unit, f"one for each of {len(given)}"))
    if len(sizes) != len(names[1]) or any(size < 1 for size in sizes):
        problems.append(Problem("surrogate", "output_sizes", sizes, "one positive size for each output"))
    return problems


def _checked(
    samples: Samples,
    input_names: tuple[str, ...],
    output_names: tuple[str, ...],
    sizes: tuple[int, ...],
    lower: Float[np.ndarray, " d"],
    upper: Float[np.ndarray, " d"],
) -> Samples:
    """Samples that can be trained on, without repeated points."""
    if len(input_names) != len(lower):
        _refuse([Problem("surrogate", "lower, upper", len(lower), f"{len(input_names)} bounds, one an input")])
    columns = [
        name if size == 1 else f"{name}[{i}]"
        for name, size in zip(output_names, sizes, strict=True)
        for i in range(size)
    ]
    _refuse(shape_problems(samples, len(input_names), len(columns)))
    _refuse(value_problems(samples, input_names, columns, lower, upper))
    samples, problems = without_twins(samples, columns, lower, upper)
    _refuse(problems)
    _refuse(shape_problems(samples, len(input_names), len(columns)))
    return samples


def _reduce(
    y: Float[np.ndarray, "n m"], names: tuple[str, ...], sizes: tuple[int, ...], tolerance: float
) -> tuple[list[_Output], Float[np.ndarray, "n k"]]:
    """Each output as scores of variance 1: a scalar gives one, an array one a mode, a constant none."""
    outputs, scores, column, score = [], [np.empty((len(y), 0))], 0, 0
    for name, size in zip(names, sizes, strict=True):
        here = slice(column, column + size)
        reduced, values = pod.decompose(y[:, here], tolerance)
        if is_constant(y[:, here]):
            reduced, values = reduced._replace(modes=np.empty((size, 0))), values[:, :0]
        outputs.append(_Output(name, here, slice(score, score + values.shape[1]), reduced))
        scores.append(values)
        column, score = here.stop, score + values.shape[1]
    return outputs, np.concatenate(scores, axis=1)


def _label(output: _Output, mode: int) -> str:
    """Name of one score for progress and messages."""
    count = output.pod.modes.shape[1]
    return output.name if count == 1 else f"{output.name} (mode {mode + 1} of {count})"


def _judge(output: _Output, unseen: dict[Kind, Float[np.ndarray, "n k"]], samples: Samples) -> dict[Kind, Quality]:
    """Quality of each model of one output on the unseen points."""
    actual, trained_on = samples.y_test[:, output.columns], samples.y[:, output.columns]
    if output.pod.modes.shape[1] == 0:
        constant = np.broadcast_to(output.pod.mean, actual.shape)
        return {"constant": measure(constant, actual, trained_on)}
    return {
        kind: measure(output.pod.mean + scores[:, output.scores] @ output.pod.modes.T, actual, trained_on)
        for kind, scores in unseen.items()
    }


def _better(models: dict[Kind, Quality]) -> Kind:
    """The kind of model with the lower RMSE."""
    ranked: list[Kind] = sorted(models, key=lambda kind: models[kind].rmse)
    return ranked[0]


def _assemble(
    outputs: list[_Output],
    kinds: tuple[Kind, ...],
    krg: kriging.KrigingModel,
    radial: rbf.RbfModel,
    lower: Float[np.ndarray, " d"],
    upper: Float[np.ndarray, " d"],
) -> Predictor:
    """Only the chosen scores of each model, and the matrix that turns them into outputs."""
    offset = np.concatenate([output.pod.mean for output in outputs])
    kept: dict[Kind, list[int]] = {"kriging": [], "rbf": [], "constant": []}
    lift = np.zeros((offset.size, outputs[-1].scores.stop))
    for output, kind in zip(outputs, kinds, strict=True):
        kept[kind].extend(range(output.scores.start, output.scores.stop))
        lift[output.columns, output.scores] = output.pod.modes
    return Predictor(
        lower=lower,
        upper=upper,
        kriging=kriging.select(krg, kept["kriging"]),
        rbf=rbf.select(radial, kept["rbf"]),
        offset=offset,
        lift=lift[:, kept["kriging"] + kept["rbf"]],
    )
