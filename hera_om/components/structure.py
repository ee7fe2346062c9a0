"""A definition split for JAX: its numbers as one array, everything else as a hashable static."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import jax.numpy as jnp
import numpy as np

from hera_om.aircraft.definition import Aircraft
from hera_om.aircraft.paths import blank, fill, numbers, variable_box


class Structure:
    """Everything of a definition but its numbers; two aircraft of one structure share their compiled code."""

    def __init__(self, aircraft: Aircraft) -> None:
        self.blank = blank(aircraft)
        self._index = {path: i for i, path in enumerate(numbers(aircraft))}
        self._hash = hash(self.blank)

    def __hash__(self) -> int:
        """Hash of the structure, computed once."""
        return self._hash

    def __eq__(self, other: object) -> bool:
        """Equal structures, whatever the numbers."""
        return isinstance(other, Structure) and self._hash == other._hash and self.blank == other.blank

    def __repr__(self) -> str:
        """All of the structure, see `core.programs`."""
        return f"Structure({self.blank!r})"

    def aircraft(self, base, changes: Mapping[str, Any]) -> Aircraft:
        """The definition with ``base`` as its numbers, some replaced by path; traced values are welcome."""
        values = list(jnp.asarray(base))
        for path, value in changes.items():
            values[self._index[path]] = value
        return fill(self.blank, values)


def number_array(aircraft: Aircraft) -> np.ndarray:
    """Numbers of a definition in the order of its structure."""
    return np.array(list(numbers(aircraft).values()), float)


class Variable(NamedTuple):
    """A design variable of a definition."""

    name: str
    path: str
    value: float
    units: str | None


def variables_under(aircraft: Aircraft, prefixes: Sequence[str]) -> list[Variable]:
    """The design variables whose paths begin with one of these."""
    box = variable_box(aircraft)
    found = map(Variable, box.names, box.paths, box.baseline, box.units)
    return [v for v in found if any(v.path == p or v.path.startswith(p + ".") for p in prefixes)]
