"""What a driver script runs: analysis, trim, optimisation, training; each returns plain data."""

from typing import Any

_HOME = {
    "analyze": "analysis",
    "interact": "interaction",
    "trim": "trimming",
    "mdo": "optimisation",
    "run": "optimisation",
    "train": "training",
}

__all__ = ["analyze", "interact", "mdo", "run", "train", "trim"]


def __getattr__(name: str) -> Any:
    """Import a study when it is asked for."""
    if name not in _HOME:
        raise AttributeError(name)
    import importlib

    return getattr(importlib.import_module(f"hera_om.studies.{_HOME[name]}"), name)
