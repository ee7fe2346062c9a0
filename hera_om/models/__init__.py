"""OpenMDAO groups and problems: they only connect; variables and constraints of each case stand in `cases`."""

import importlib
from typing import Any

_HOME = {
    "TrimPoint": "trimmed",
    "TrimmedAircraft": "trimmed",
    "build_aircraft": "problems",
    "build_mdo": "problems",
    "build_trim": "problems",
}

__all__ = ["TrimPoint", "TrimmedAircraft", "build_aircraft", "build_mdo", "build_trim"]


def __getattr__(name: str) -> Any:
    """Import a group or a builder on first use."""
    if name not in _HOME:
        raise AttributeError(f"module 'hera_om.models' has no attribute {name!r}")
    return getattr(importlib.import_module(f"hera_om.models.{_HOME[name]}"), name)
