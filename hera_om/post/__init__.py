"""Databases in; tables, figures and reports out. Nothing here runs a model.

Every function takes the path of a database or a `Run` that `read` has made of it.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from hera_om.post.database import Run as Run
    from hera_om.post.database import cases as cases
    from hera_om.post.database import read as read
    from hera_om.post.figures import plot_constraints as plot_constraints
    from hera_om.post.figures import plot_history as plot_history
    from hera_om.post.figures_budget import plot_drag as plot_drag
    from hera_om.post.figures_budget import plot_gain as plot_gain
    from hera_om.post.figures_budget import plot_masses as plot_masses
    from hera_om.post.figures_pressure import plot_pressure as plot_pressure
    from hera_om.post.figures_shape import plot_box as plot_box
    from hera_om.post.figures_shape import plot_planform as plot_planform
    from hera_om.post.figures_shape import plot_span_load as plot_span_load
    from hera_om.post.figures_short_period import plot_thumbprint as plot_thumbprint
    from hera_om.post.report import write_report as write_report
    from hera_om.post.tables import comparison as comparison
    from hera_om.post.tables import constraints as constraints
    from hera_om.post.tables import drag as drag
    from hera_om.post.tables import gain as gain
    from hera_om.post.tables import history as history
    from hera_om.post.tables import masses as masses
    from hera_om.post.tables import variables as variables

_MODULES = {
    "database": ("Run", "cases", "read"),
    "tables": ("comparison", "constraints", "drag", "gain", "history", "masses", "variables"),
    "figures": ("plot_constraints", "plot_history"),
    "figures_pressure": ("plot_pressure",),
    "figures_shape": ("plot_box", "plot_planform", "plot_span_load"),
    "figures_short_period": ("plot_thumbprint",),
    "figures_budget": ("plot_drag", "plot_gain", "plot_masses"),
    "report": ("write_report",),
}
_HOME = {name: module for module, names in _MODULES.items() for name in names}

__all__ = [
    "Run",
    "cases",
    "comparison",
    "constraints",
    "drag",
    "gain",
    "history",
    "masses",
    "plot_box",
    "plot_constraints",
    "plot_drag",
    "plot_gain",
    "plot_history",
    "plot_masses",
    "plot_planform",
    "plot_pressure",
    "plot_span_load",
    "plot_thumbprint",
    "read",
    "variables",
    "write_report",
]


def __getattr__(name: str) -> Any:
    """Import on first use: pandas and matplotlib are slow to load."""
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    value = getattr(import_module(f"{__name__}.{_HOME[name]}"), name)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOME})
