"""Optimisation of distributed-electric-propulsion aircraft: one differentiable OpenMDAO graph.

``load_aircraft`` and the subpackages are imported when they are first asked for, so that nothing heavy loads early.
"""

import importlib
from typing import Any

_SUBPACKAGES = ("aircraft", "components", "core", "models", "physics", "post", "studies", "surrogates")

__all__ = ["load_aircraft", *_SUBPACKAGES]


def __getattr__(name: str) -> Any:
    """Import a subpackage, or the loader of definitions, on first use."""
    if name in _SUBPACKAGES:
        return importlib.import_module(f"hera_om.{name}")
    if name == "load_aircraft":
        return importlib.import_module("hera_om.aircraft").load_aircraft
    raise AttributeError(f"module 'hera_om' has no attribute {name!r}")
