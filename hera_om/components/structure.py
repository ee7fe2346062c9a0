"""A definition split for JAX: its numbers as one array, everything else as a hashable static."""

from collections.abc import Mapping
from typing import Any

import jax.numpy as jnp
import numpy as np

from hera_om.aircraft.definition import Aircraft
from hera_om.aircraft.paths import blank, fill, numbers


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
