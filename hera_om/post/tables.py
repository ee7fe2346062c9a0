"""The record of a run as pandas frames; numbers keep the units that the registry gives them.

An empty unit is a number without dimension.
"""

from pathlib import Path
from typing import Any

import pandas as pd

from hera_om.core.registry import quantity
from hera_om.post.database import Run, Snapshot, as_run

Source = str | Path | Run
Row = dict[str, Any]

DRAG_PARTS = {
    "CDi_near": "induced, near field",
    "CD_slipstream": "slipstream",
    "CD_profile": "profile",
    "CD_fuselage": "fuselage",
    "CD_areas": "fixed areas",
}
"""What the drag coefficient is the sum of."""

WING_PARTS = {
    "m_skins": "skins",
    "m_webs": "spar webs",
    "m_caps": "spar caps",
    "m_stringers": "stringers",
    "m_ribs": "ribs",
    "m_centre_section": "centre section",
    "m_penalties": "joints and attachments",
    "m_secondary": "secondary structure",
    "m_remainder": "fixed remainder",
}
"""What the mass of the wing is the sum of."""

DESIGNS = ("baseline", "optimum")


def rows(frame: pd.DataFrame) -> list[Row]:
    """A frame as one dictionary a row, the index under its name."""
    return [{str(k): v for k, v in row.items()} for row in frame.reset_index().to_dict("records")]


def variables(source: Source) -> pd.DataFrame:
    """Design variables by name: units, bounds, both designs, the way through the box, multiplier."""
    run = as_run(source)
    told = [vars(v) | {"units": v.units or ""} for v in run.variables]
    frame = pd.DataFrame(told, columns="name path units lower baseline upper".split()).set_index("name")
    found = _values(run, "optimum")
    frame.insert(4, "optimum", pd.Series({v.name: found.get(v.name) for v in run.variables}, dtype=float))
    box = (frame["upper"] - frame["lower"]).astype(float)
    frame["moved_percent_of_box"] = 100.0 * (frame["optimum"] - frame["baseline"]) / box
    frame["place_in_box"] = (frame["optimum"] - frame["lower"]) / box
    last = (run.result or {}).get("variables") or {}
    multipliers = {v.name: (last.get(v.name) or {}).get("multiplier") for v in run.variables}
    frame["multiplier"] = pd.Series(multipliers, dtype=float)
    return frame


def constraints(source: Source) -> pd.DataFrame:
    """Constraints by name: bounds, both designs, the final one's margin, multiplier, state, reason.

    The margin is to the nearer bound, in the unit of the constraint and in percent of the bound;
    a negative one is a violation.
    """
    run = as_run(source)
    found = {d: _values(run, d) for d in DESIGNS}
    told = (run.result or {}).get("constraints") or {}
    lines: list[Row] = []
    for c in run.constraints:
        row: Row = {"name": c.name, "units": c.units or "", "lower": c.lower, "upper": c.upper}
        row |= {d: found[d].get(c.name) for d in DESIGNS}
        last = told.get(c.name, {})
        if row["optimum"] is None:
            row["optimum"] = last.get("value")
        if row["optimum"] is not None:
            row["margin"] = c.margin(row["optimum"])
            row["margin_percent"] = 100.0 * c.relative(row["optimum"])
        row |= {k: last.get(k) for k in ("multiplier", "active", "violated")} | {"reason": c.reason}
        lines.append(row)
    columns = "name units lower upper baseline optimum margin margin_percent".split()
    columns += "multiplier active violated reason".split()
    frame = pd.DataFrame(lines, columns=columns).set_index("name")
    numbers = ["lower", "upper", "baseline", "optimum", "margin", "margin_percent", "multiplier"]
    return frame.astype(dict.fromkeys(numbers, float))


def history(source: Source) -> pd.DataFrame:
    """One row an evaluation: time_s, objective, worst_violation, success, then every recorded number."""
    run = as_run(source)
    lines: list[Row] = []
    for row in run.history:
        numbers = row.get("outputs", {}) | row.get("constraints", {}) | row.get("variables", {})
        head = {k: row.get(k) for k in ("iteration", "time_s", "objective", "worst_violation")}
        lines.append(head | {"success": bool(row.get("success", True))} | numbers)
    empty = ["iteration", "time_s", "objective", "worst_violation", "success"]
    frame = pd.DataFrame(lines, columns=None if lines else empty)
    frame = frame.set_index("iteration")
    return frame.astype({c: float for c in frame.columns if c != "success"})


def comparison(source: Source) -> pd.DataFrame:
    """Every number of both snapshots: units, baseline, optimum, change, change in percent, meaning."""
    run = as_run(source)
    found = {d: _values(run, d) for d in DESIGNS}
    names = list(found["baseline"]) + [n for n in found["optimum"] if n not in found["baseline"]]
    frame = pd.DataFrame({d: pd.Series(found[d], index=names, dtype=float) for d in DESIGNS})
    frame.index.name = "name"
    frame.insert(0, "units", [_unit(run, n) or "" for n in names])
    frame["change"] = frame["optimum"] - frame["baseline"]
    before, after = frame["baseline"].abs(), frame["optimum"].abs()
    telling = (before > 1e-9) & (before > 1e-6 * after)  # a residual has no change in percent
    frame["change_percent"] = 100.0 * frame["change"] / before.where(telling)
    frame["meaning"] = [_meaning(n) for n in names]
    return frame


def drag(source: Source) -> pd.DataFrame:
    """Drag coefficient by part in counts (1e-4), the recorded total last."""
    run = as_run(source)
    found = {d: _values(run, d) for d in DESIGNS}
    parts = {d: {k: found[d][k] for k in (*DRAG_PARTS, "CD") if k in found[d]} for d in DESIGNS}
    return _budget(parts, DRAG_PARTS, "CD", 1e4)


def masses(source: Source) -> pd.DataFrame:
    """Masses in kg by group (``aircraft``: mass items, ``wing``: parts of the wing) and item, totals last."""
    run = as_run(source)
    items, parts = {}, {}
    for d in DESIGNS:
        shot = _shot(run, d)
        items[d] = {k: float(v) for k, v in (shot.arrays.get("mass_items") or {}).items()}
        items[d] |= {"mass": shot.values["mass"]} if "mass" in shot.values else {}
        parts[d] = _wing_parts(shot)
    groups = {"aircraft": _budget(items, {}, "mass", 1.0), "wing": _budget(parts, WING_PARTS, "m_wing", 1.0)}
    return pd.concat(groups, names=["group", "item"])


def gain(source: Source) -> pd.Series:
    """The objective's change split by cause, in the objective's unit; empty where it was not split."""
    run = as_run(source)
    told = (run.result or {}).get("gain") or {}
    told = {cause: value for cause, value in told.items() if cause != "total"}
    return pd.Series(told, dtype=float, name=run.objective.name if run.objective else "gain")


def _budget(found: dict[str, dict], labels: dict[str, str], total: str, factor: float) -> pd.DataFrame:
    """Parts of both designs and their change; what the parts leave of the total gets a row of its own."""
    names = [n for n in dict.fromkeys([*found["baseline"], *found["optimum"]]) if n != total]
    frame = pd.DataFrame({d: pd.Series(found[d], index=[*names, total], dtype=float) * factor for d in DESIGNS})
    frame = frame.dropna(how="all")
    frame.index = pd.Index([labels.get(n, n) for n in frame.index], name="item", dtype=object)
    if total in frame.index:
        rest = frame.loc[total] - frame.drop(total).sum()
        frame = frame.rename({total: "total"})
        if len(frame) > 1 and (rest.abs() > 1e-3 * frame.loc["total"].abs()).any():
            frame = pd.concat([frame.iloc[:-1], rest.to_frame("not itemised").T, frame.iloc[-1:]])
            frame.index.name = "item"
    frame["change"] = frame["optimum"] - frame["baseline"]
    return frame


def _wing_parts(shot: Snapshot) -> dict[str, float]:
    """Parts of the wing; the secondary structure is what primary, penalties and remainder leave of the whole."""
    known = dict(shot.values)
    if {"m_wing", "m_primary", "m_remainder"} <= set(known):
        rest = known["m_primary"] + known["m_remainder"] + known.get("m_penalties", 0.0)
        known["m_secondary"] = known["m_wing"] - rest
    return {k: known[k] for k in (*WING_PARTS, "m_wing") if k in known}


def _shot(run: Run, design: str) -> Snapshot:
    """A snapshot, empty where the run has none."""
    return getattr(run, design) or Snapshot({})


def _values(run: Run, design: str) -> dict[str, float]:
    """Numbers of a design: those of the result, overruled by the snapshot's."""
    told = (run.result or {}).get(design) or {}
    numbers = {k: float(v) for k, v in told.items() if isinstance(v, int | float)}
    return numbers | _shot(run, design).values


def _unit(run: Run, name: str) -> str | None:
    """Unit of a number: as recorded with a snapshot, else the registry's."""
    for design in DESIGNS:
        if name in _shot(run, design).units:
            return _shot(run, design).units[name]
    try:
        return quantity(name).units
    except KeyError:
        return next((v.units for v in (*run.variables, *run.constraints) if v.name == name), None)


def _meaning(name: str) -> str:
    """What the registry says about a name; nothing for a name that it lacks."""
    try:
        return quantity(name).desc
    except KeyError:
        return ""
