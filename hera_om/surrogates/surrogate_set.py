"""A trained set of surrogates: all outputs of a discipline at once, in JAX, and how good each is."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Literal, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float
from numpy.typing import ArrayLike

from hera_om.surrogates import domain, kriging, rbf
from hera_om.surrogates.quality import Quality
from hera_om.surrogates.samples import Samples

Kind = Literal["kriging", "rbf", "constant"]

BATCH = 64
"""Points that ``evaluate_many`` computes side by side; it bounds the memory of a long list of points."""


class Predictor(NamedTuple):
    """The arrays behind a set: y = offset + lift @ [Kriging outputs, RBF outputs].

    ``lift`` holds the standard deviation of a scalar output and the scaled modes of an array output; the
    row of a constant output is zero.
    """

    lower: Float[np.ndarray, " d"]
    upper: Float[np.ndarray, " d"]
    kriging: kriging.KrigingModel
    rbf: rbf.RbfModel
    offset: Float[np.ndarray, " m"]
    lift: Float[np.ndarray, "m k"]


def predict(predictor: Predictor, x: Float[Array, " d"]) -> Float[Array, " m"]:
    """All outputs at one point, in the units of the samples: pure, for use inside other JAX functions.

    Args:
        predictor: arrays of a trained set.
        x: inputs in the units and the order of training. Nothing is clipped at the bounds: ask ``outside``.

    Returns:
        The outputs in the order of training, the entries of an array output side by side.
    """
    u = (x - predictor.lower) / (predictor.upper - predictor.lower)
    scores = jnp.concatenate([kriging.predict(predictor.kriging, u), rbf.predict(predictor.rbf, u)])
    return jnp.asarray(predictor.offset) + jnp.asarray(predictor.lift) @ scores


# Compiled once a process for each shape of the arrays: they are arguments, so two sets share a compilation.
_evaluate = jax.jit(predict)
_evaluate_many = jax.jit(lambda p, x: jax.lax.map(lambda row: predict(p, row), x, batch_size=BATCH))
_jacobian = jax.jit(jax.jacfwd(predict, argnums=1))


@dataclass(frozen=True, eq=False)
class SurrogateSet:
    """Surrogates of all outputs of a discipline over one box of inputs.

    Attributes:
        input_names: names of the inputs, in order.
        input_units: their units, as the caller gave them; None where there is none.
        output_names: names of the outputs, in order.
        output_units: their units, likewise.
        output_sizes: number of entries of each output.
        kinds: model that each output uses.
        quality: errors of both models of each output on the unseen points; a constant output has only itself.
        predictor: the arrays that ``evaluate`` computes with.
        samples: what the set was trained and judged on; a repeated training point is there once.
        seed: seed of the training.
        definition_hash: hash of the aircraft behind the samples, as the caller gave it.
        versions: versions of the packages that trained the set.
    """

    input_names: tuple[str, ...]
    input_units: tuple[str | None, ...]
    output_names: tuple[str, ...]
    output_units: tuple[str | None, ...]
    output_sizes: tuple[int, ...]
    kinds: tuple[Kind, ...]
    quality: tuple[Mapping[Kind, Quality], ...]
    predictor: Predictor = field(repr=False)
    samples: Samples = field(repr=False)
    seed: int
    definition_hash: str
    versions: Mapping[str, Any] = field(repr=False)

    def evaluate(self, x: ArrayLike) -> Float[Array, " m"]:
        """All outputs at one point x [d]; see ``predict``."""
        return _evaluate(self._device, jnp.asarray(x, dtype=float))

    def evaluate_many(self, x: ArrayLike) -> Float[Array, "n m"]:
        """All outputs at n points x [n, d]."""
        return _evaluate_many(self._device, jnp.asarray(x, dtype=float))

    def jacobian(self, x: ArrayLike) -> Float[Array, "m d"]:
        """Exact derivatives of all outputs by all inputs at one point x [d]."""
        return _jacobian(self._device, jnp.asarray(x, dtype=float))

    @cached_property
    def slices(self) -> dict[str, slice]:
        """Where each output stands in the vector of ``evaluate``."""
        ends = np.cumsum(self.output_sizes)
        return {
            name: slice(int(end - size), int(end))
            for name, size, end in zip(self.output_names, self.output_sizes, ends, strict=True)
        }

    @property
    def lower(self) -> Float[np.ndarray, " d"]:
        """Lower bounds of the inputs."""
        return self.predictor.lower

    @property
    def upper(self) -> Float[np.ndarray, " d"]:
        """Upper bounds of the inputs."""
        return self.predictor.upper

    def chosen(self, name: str) -> Quality:
        """Quality of the model that an output uses."""
        i = self.output_names.index(name)
        return self.quality[i][self.kinds[i]]

    def shortfalls(self) -> dict[str, list[str]]:
        """Outputs that miss a threshold of the paper, with the thresholds that they miss."""
        missed = {name: self.chosen(name).shortfalls() for name in self.output_names}
        return {name: texts for name, texts in missed.items() if texts}

    def table(self) -> list[dict[str, Any]]:
        """One row for each model of each output: a table of both models' errors, for print or pandas."""
        return [
            {"output": name, "unit": unit, "size": size, "model": kind, "chosen": kind == used}
            | quality._asdict()
            | {"meets": not quality.shortfalls()}
            for name, unit, size, used, models in zip(
                self.output_names, self.output_units, self.output_sizes, self.kinds, self.quality, strict=True
            )
            for kind, quality in models.items()
        ]

    @cached_property
    def _device(self) -> Predictor:
        """The arrays as JAX holds them, so that a call does not copy them again.

        Even where the first call happens inside a trace, whose tracers must not outlive it.
        """
        with jax.ensure_compile_time_eval():
            return jax.tree.map(jnp.asarray, self.predictor)


def outside(surrogates: SurrogateSet, x: ArrayLike) -> list[domain.Outside]:
    """Every input of one point x [d] that lies outside the box of the training samples; see ``domain``."""
    return domain.outside(surrogates.input_names, np.asarray(x, dtype=float), surrogates.lower, surrogates.upper)
