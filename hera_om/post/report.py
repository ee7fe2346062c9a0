"""The report of a run: one self-contained HTML page, made from its database alone."""

import json
import math
import os
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pandas as pd

from hera_om.core.errors import RecordError
from hera_om.post import figures, figures_budget, figures_pressure, figures_shape, figures_short_period, page, tables
from hera_om.post.database import Run, read
from hera_om.post.style import number, readable

MAIN = (
    "range_fixed_mass range_fixed_fuel range_per_energy L_over_D CL CD CDi power thrust m_wing mass "
    "alpha delta_e static_margin x_np x_cg omega_sp zeta_sp CAP omega_ph zeta_ph RFC RFT"
).split()
"""What the comparison shows at once; everything else unfolds."""

AT_BOUND = 2e-3
"""Share of its range from which on a variable is said to stand at a bound."""


class Pane(NamedTuple):
    """A part of the page: where it stands, what it is called, what writes it, and for which kinds of run."""

    anchor: str
    title: str
    write: Callable[[Run], str]
    kinds: tuple[str, ...] = ("mdo", "trim", "analyze")


def write_report(database: str | Path, target: str | Path) -> Path:
    """Write the page of a run.

    A pane that fails is replaced by a note with the reason, the others stay.

    Args:
        database: what `hera_om.studies.record.Record` wrote, finished or not.
        target: the HTML file; an older one is replaced once the new one is complete.

    Returns:
        The path written.

    Raises:
        RecordError: the database cannot be read or the page cannot be written.
    """
    run, target = read(database), Path(target)
    text = render(run)
    partial = target.with_name(f".{target.name}.{os.getpid()}")
    try:
        partial.write_text(text, encoding="utf-8")
        os.replace(partial, target)
    except OSError as error:
        partial.unlink(missing_ok=True)
        raise RecordError(f"{target}: the report cannot be written: {error}") from error
    return target


def render(run: Run) -> str:
    """The page as text."""
    panes = [p for p in PANES if run.kind in p.kinds]
    links = "".join(f'<a href="#{p.anchor}">{page.escape(p.title)}</a>' for p in panes)
    sections = [page.section(p.anchor, p.title, _guarded(p.write, run)) for p in panes]
    body = "\n".join([_guarded(_head, run), f"<nav>{links}</nav>", *sections])
    return page.document(f"{_name(run)}: {run.kind}", body)


def _guarded(write: Callable[[Run], str], run: Run) -> str:
    """A pane, or why there is none; whatever goes wrong in one must not cost the others."""
    try:
        return write(run)
    except Exception as error:
        return page.note(f"This pane could not be made: {type(error).__name__}: {error}")


def _name(run: Run) -> str:
    """Name of the aircraft, or of the file where the definition does not load."""
    try:
        return run.aircraft.name
    except RecordError:
        return run.path.name


def _head(run: Run) -> str:
    """What ran, how it ended, and the objective."""
    told = run.result or {}
    what = {"mdo": "Optimisation", "trim": "Trim", "analyze": "Analysis"}.get(run.kind, run.kind)
    lines = [f"<header><h1>{page.escape(_name(run))}</h1>"]
    source = f"{what} · definition {run.definition_hash[:12]} · started {_time(run.started)}"
    lines += [f'<p class="soft">{page.escape(source)}</p>', *_badges(run)]
    if run.failure:
        lines.append(page.note(f"The run stopped: {run.failure.get('message', 'no reason recorded')}"))
    elif run.status == "unfinished":
        lines.append(page.note(f"The run has not finished; {len(run.history)} evaluations are on record."))
    elif told.get("message"):
        lines.append(f"<p>{page.escape(told['message'])}</p>")
    if told.get("failures"):
        failed = f"{len(told['failures'])} of the driver's attempts ended in a failed analysis; "
        lines.append(page.note(f"{failed}the last: {told['failures'][-1]}"))
    lines += [page.facts(_facts(run)), f'<p class="soft">{page.escape(_versions(run))}</p></header>']
    return "\n".join(lines)


def _badges(run: Run) -> list[str]:
    """Success and feasibility as the run's own check found them."""
    told = run.result
    if told is None:
        return [page.badge(run.status, "bad")]
    badges = []
    for key, yes, no in (("success", "converged", "not converged"), ("feasible", "feasible", "infeasible")):
        if told.get(key) is not None:
            badges.append(page.badge(yes, "good") if told[key] else page.badge(no, "bad"))
    return badges


def _facts(run: Run) -> list[tuple[str, str]]:
    """The figures of the head."""
    told, pairs = run.result or {}, []
    for row in tables.rows(tables.comparison(run)):
        if run.objective is None or row["name"] != run.objective.name:
            continue
        before, after, unit = _shown(row)
        value = " → ".join(v for v in (before, after) if v != "–") + f" {unit}"
        pairs.append((run.objective.name, value.strip() + _percent(row["change_percent"], " ({})")))
    pairs += [(k, str(run.options[k])) for k in ("driver", "aero") if run.options.get(k) is not None]
    counts = [(k, told[k]) for k in ("iterations", "evaluations", "gradients") if told.get(k) is not None]
    pairs += [(k, f"{v:d}" if isinstance(v, int) else str(v)) for k, v in counts]
    if told.get("seconds") is not None:
        pairs.append(("time", f"{told['seconds']:.1f} s"))
    return pairs


def _versions(run: Run) -> str:
    """The versions that matter most; the rest stands at the end of the page."""
    names = ("hera_om", "openmdao", "jax", "numpy", "scipy")
    known = [f"{k.replace('_', '-')} {run.provenance[k]}" for k in names if run.provenance.get(k)]
    if revision := run.provenance.get("revision"):
        known.append(f"revision {revision[:10]}" + (" with changes" if run.provenance.get("modified") else ""))
    return ", ".join(known)


def _time(moment: str | None) -> str:
    """ISO 8601 as people write it."""
    return (moment or "at an unknown time").replace("T", " ").replace("+00:00", " UTC")


def _shown(row: tables.Row) -> tuple[str, str, str]:
    """Both values of a row in a unit that is fit to be read."""
    size = row["baseline"] if not math.isnan(row["baseline"]) else row["optimum"]
    factor, unit = readable(row["units"], size)
    return number(factor * row["baseline"]), number(factor * row["optimum"]), unit


def _percent(value: float | None, form: str = "{}") -> str:
    """A signed change in percent; nothing for an unknown one."""
    if value is None or math.isnan(value):
        return ""
    sign = "+" if value > 0.0 else "−" if value < 0.0 else ""
    return form.format(f"{sign}{number(abs(value), 3)} %")


def _comparison(run: Run) -> str:
    """The numbers that matter, the rest folded."""
    frame = tables.comparison(run)
    if frame.empty:
        return page.note("No snapshot was recorded.")
    mine = [n for n in MAIN if n in frame.index]
    mine[12:12] = [n for n in frame.index if n.startswith("theta_") and n not in {v.name for v in run.variables}]
    if run.objective and run.objective.name in frame.index:
        mine = [run.objective.name, *(n for n in mine if n != run.objective.name)]
    rest = frame.drop(mine)
    text = _comparison_table(frame.loc[mine] if mine else frame, run)
    return text + (
        page.folded(f"{len(rest)} further numbers", _comparison_table(rest, run)) if len(rest) and mine else ""
    )


def _comparison_table(frame: pd.DataFrame, run: Run) -> str:
    """Rows of the comparison; one value where the run has one design only."""
    both = bool(frame["baseline"].notna().any() and frame["optimum"].notna().any())
    rows = []
    for row in tables.rows(frame):
        before, after, unit = _shown(row)
        values = [before, after, _percent(row["change_percent"])] if both else [before if before != "–" else after]
        rows.append([row["name"], unit, *values, row["meaning"]])
    head = ["quantity", "unit", *(["baseline", "optimum", "change"] if both else ["value"]), "meaning"]
    return page.table(head, rows, text=(0, 1, len(head) - 1))


def _variables(run: Run) -> str:
    """Table of the design variables."""
    rows = []
    for v, row in zip(run.variables, tables.rows(tables.variables(run)), strict=True):
        factor, unit = readable(v.units, v.upper)
        numbers = [number(factor * row[k]) for k in ("lower", "baseline", "optimum", "upper")]
        place, moved = row["place_in_box"], _percent(row["moved_percent_of_box"])
        at = "lower" if place < AT_BOUND else "upper" if place > 1.0 - AT_BOUND else ""
        rows.append([v.name, unit, *numbers, moved, at, number(row["multiplier"] / factor, 3)])
    head = [
        *"variable unit lower baseline optimum upper".split(),
        "moved, of the box",
        "at bound",
        "multiplier",
    ]
    return page.table(head, rows, text=(0, 1, 7)) if rows else page.note("The run has no design variables.")


def _constraints(run: Run) -> str:
    """Figure and table of the constraints."""
    frame = tables.constraints(run)
    if frame.empty:
        return page.note("The run has no constraints.")
    rows, classes = [], []
    for row in tables.rows(frame):
        factor, unit = readable(row["units"], row["optimum"])
        numbers = [number(factor * row[k]) for k in ("lower", "baseline", "optimum", "upper")]
        numbers.append(_percent(row["margin_percent"]))
        state = "violated" if row["violated"] else "active" if row["active"] else ""
        rows.append([row["name"], unit, *numbers, number(row["multiplier"] / factor, 3), state, row["reason"]])
        classes.append("bad" if row["violated"] else "")
    head = "constraint unit lower baseline optimum upper margin multiplier state reason".split()
    text = page.table(head, rows, text=(0, 1, 8, 9), classes=classes)
    return _figure("constraints", "margins of the constraints", figures.plot_constraints)(run) + text + _optimality(run)


def _optimality(run: Run) -> str:
    """How far the multipliers explain the objective's gradient."""
    told = (run.result or {}).get("optimality") or {}
    if told.get("gradient") is None or told.get("residual") is None:
        return ""
    left, whole = number(told["residual"], 3), number(told["gradient"], 3)
    told = f"Of the objective's gradient, {whole} over the variables' ranges, the multipliers leave {left}."
    return f'<p class="soft">{page.escape(told)}</p>'


def _budget_table(frame: pd.DataFrame, unit: str) -> str:
    """Parts and total of drag or mass."""
    shown = [k for k in ("baseline", "optimum", "change") if bool(frame[k].notna().any())]
    rows = [[row["item"], *(number(row[k]) for k in shown)] for row in tables.rows(frame)]
    classes = ["sum" if n == "total" else "" for n in frame.index]
    return page.table(["part", *(f"{k} [{unit}]" for k in shown)], rows, classes=classes)


def _drag(run: Run) -> str:
    """Figure and table of the drag."""
    frame = tables.drag(run)
    picture = _figure("drag", "drag by part", figures_budget.plot_drag)(run)
    return picture + (_budget_table(frame, "counts") if len(frame) else "")


def _masses(run: Run) -> str:
    """Figure and tables of the masses."""
    frame, text = tables.masses(run), _figure("masses", "masses by item", figures_budget.plot_masses)(run)
    for group, title in (("aircraft", "Items of the aircraft"), ("wing", "Parts of the wing")):
        if group in frame.index.get_level_values("group"):
            text += page.folded(title, _budget_table(frame.loc[group], "kg"))
    return text


def _origin(run: Run) -> str:
    """Versions, options and the definition itself."""
    rows = [[k, json.dumps(v) if isinstance(v, dict | list) else str(v)] for k, v in run.options.items()]
    versions = [[k.replace("_", "-"), "unknown" if v is None else str(v)] for k, v in run.provenance.items()]
    ended = _time(run.finished) if run.finished else "never"
    told = f"Database {run.path.name}, definition {run.definition_hash}, "
    told += f"started {_time(run.started)}, closed {ended}."
    return "".join(
        [
            f'<p class="soft">{page.escape(told)}</p>',
            page.folded("Options", page.table(["option", "value"], rows, text=(0, 1))) if rows else "",
            page.folded("Versions", page.table(["package", "version"], versions, text=(0, 1))),
            page.folded("Definition", f"<pre>{page.escape(run.definition)}</pre>"),
        ]
    )


def _figure(name: str, description: str, plot: Callable) -> Callable[[Run], str]:
    """A pane that is one figure."""
    return lambda run: page.picture(plot(run), name, description)


SEARCHES = ("mdo", "trim")
PANES = (
    Pane("comparison", "Main numbers", _comparison),
    Pane("variables", "Design variables", _variables, SEARCHES),
    Pane("constraints", "Constraints", _constraints, SEARCHES),
    Pane("gain", "Gain by cause", _figure("gain-figure", "gain by cause", figures_budget.plot_gain), ("mdo",)),
    Pane("history", "History", _figure("history-figure", "history of the run", figures.plot_history), SEARCHES),
    Pane("planform", "Planform and rotors", _figure("planform-figure", "planform", figures_shape.plot_planform)),
    Pane(
        "load",
        "Load along the span",
        _figure("load-figure", "load along the span", figures_shape.plot_span_load),
    ),
    Pane(
        "pressure", "Pressure", _figure("pressure-figure", "pressure on the surfaces", figures_pressure.plot_pressure)
    ),
    Pane(
        "short-period",
        "Short-period thumbprint",
        _figure("thumb-figure", "short period", figures_short_period.plot_thumbprint),
    ),
    Pane("drag", "Drag", _drag),
    Pane("masses", "Masses", _masses),
    Pane("box", "Wing box", _figure("box-figure", "wing box along the span", figures_shape.plot_box)),
    Pane("origin", "Where this comes from", _origin),
)
