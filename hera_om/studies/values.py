"""Numbers of a problem as plain data, in the units of the registry."""

import math
from typing import Any

import numpy as np
import openmdao.api as om

from hera_om.core.registry import quantity


def known_units(name: str) -> str | None:
    """Unit of the registry for a promoted name; KeyError for a name that is not shared."""
    return quantity(name.rpartition(".")[2]).units


def number(problem: om.Problem, name: str, units: str | None = None) -> float:
    """One number of a problem."""
    return float(np.ravel(problem.get_val(name, units=units))[0])


def collect(problem: om.Problem, prefix: str = "") -> tuple[dict[str, Any], dict[str, str]]:
    """Inputs and outputs under a promoted prefix by their last name, and their units.

    Single numbers are floats, arrays are lists. A name in the registry is given in its unit, any other in the
    model's own.
    """
    model, values, units = problem.model, {}, {}
    meta = model.get_io_metadata(metadata_keys=("units", "shape"))
    names = {m["prom_name"]: m for m in meta.values()}
    for promoted, m in sorted(names.items()):
        if not promoted.startswith(prefix) or "." in promoted.removeprefix(prefix):
            continue
        name = promoted.removeprefix(prefix)
        unit = _unit(name, m["units"])
        value = np.asarray(problem.get_val(promoted, units=unit))
        values[name] = float(value.ravel()[0]) if math.prod(m["shape"]) == 1 else value.tolist()
        if unit is not None:
            units[name] = unit
    return values, units


def _unit(name: str, own: str | None) -> str | None:
    """Registry unit, or the variable's own."""
    try:
        return known_units(name)
    except KeyError:
        return own
