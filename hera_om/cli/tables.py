"""Results as aligned plain text. What a result does not have is left out."""

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from hera_om.core.registry import INPUTS, OUTPUTS, quantity

Result = Mapping[str, Any]

_COEFFICIENTS = ("CL", "CD", "CX", "CY", "CZ", "Cl", "Cm", "Cn")
_BY = "alpha beta p q r alphadot betadot mach delta_e delta_a delta_r delta_f".split()
_DERIVATIVE = re.compile(rf"(?P<row>{'|'.join(_COEFFICIENTS)})_(?P<by>{'|'.join(_BY)}|theta_\w+)")
_DRAG = ("CDi", "CD_profile", "CD_fuselage", "CD_areas", "CD_slipstream", "CD")
_ROTOR = ("theta", "thrust", "power", "CT", "CP", "eta")
_CONDITION = "alpha beta mach altitude p_hat q_hat r_hat delta_e delta_a delta_r delta_f".split()
_FORCES = ("CL", "CX", "CY", "CZ", "Cl", "Cm", "Cn", "L_over_D", "thrust", "power")
_STABILITY = "x_np static_margin omega_sp zeta_sp CAP omega_ph zeta_ph omega_dr zeta_dr tau_roll t2_spiral".split()
_MASS = "mass m_wing x_cg z_cg Ixx Iyy Izz Ixz RFC RFT".split()
_RANGE = ("range_fixed_mass", "range_fixed_fuel", "range_per_energy")
_MDO = {"alpha", "delta_e", "CL", "CD", "CDi", "L_over_D", "thrust", "power", "CAP", *_STABILITY, *_MASS, *_RANGE}
_COUNTS = 1e4  # drag counts in a drag coefficient of 1


def grid(rows: Iterable[Sequence[Any]], head: Sequence[str] = (), indent: str = "  ") -> str:
    """Rows as aligned text: the first column to the left, figures to the right."""
    table = [[_cell(c) for c in row] for row in rows]
    if not table:
        return ""
    lines = [list(head), *table] if head else table
    count = max(map(len, lines))
    lines = [line + [""] * (count - len(line)) for line in lines]
    left = [i == 0 or not any(_is_figure(line[i]) for line in lines[bool(head) :]) for i in range(count)]
    widths = [max(len(line[i]) for line in lines) for i in range(count)]
    padded = (
        "  ".join(c.ljust(w) if to_left else c.rjust(w) for c, w, to_left in zip(line, widths, left, strict=True))
        for line in lines
    )
    return "\n".join((indent + line).rstrip() for line in padded)


def check_text(result: Result) -> str:
    """Summary of a sound definition."""
    rows = [
        ("hash", result.get("hash", "")),
        ("parts", ", ".join(result.get("parts", ()))),
        ("rotor groups", ", ".join(result.get("rotors", ())) or "none"),
        ("numbers", str(result.get("numbers", ""))),
        ("design variables", _counted(result.get("variables", ()))),
    ]
    width = max(len(name) for name, _ in rows)
    return "\n".join([f"{result.get('aircraft', '')}: valid", *(f"  {n:<{width}}  {v}" for n, v in rows)])


def analyze_text(result: Result) -> str:
    """One flight condition."""
    return _join(_title(result), *_analysis(result, _units(result)))


def trim_text(result: Result) -> str:
    """Steady flight: the state with its bounds, then what ``analyze`` shows."""
    values = result.get("values", {})
    verdict = "trimmed" if result.get("trimmed", True) else "NOT TRIMMED"
    state = _section("Trim state", _trim_state(result), ("", "value", "unit", "lower", "upper", ""))
    residuals = _section("Residuals", list(result.get("residuals", {}).items()))
    return _join(f"{_title(result)}: {verdict}", state, residuals, *_analysis(values, _units(result)))


def mdo_text(result: Result) -> str:
    """Baseline against optimum in their main numbers, constraints, and the gain by cause; the record has the rest."""
    verdict = "feasible" if result.get("feasible", True) else "INFEASIBLE"
    before, after, units = result.get("baseline", {}), result.get("optimum", {}), _units(result)
    shown = {*result.get("variables", before), *_MDO}
    names = [n for n in _ordered(before) if n in after and (n in shown or n.startswith("theta_"))]
    rows = [(n, before[n], after[n], _change(before[n], after[n]), _unit(n, units)) for n in names]
    head = ("", "baseline", "optimum", "change %", "unit")
    return _join(
        f"{_title(result)}: {verdict}",
        _section("Baseline and optimum", [r for r in rows if _is_scalar(r[1]) and _is_scalar(r[2])], head),
        _records("Constraints", _without_reasons(result.get("constraints", {}))),
        _records("Gain by cause", result.get("gain", {})),
    )


def train_text(result: Result) -> str:
    """Quality of each output on unseen points."""
    rows = result.get("quality", ())
    columns = list(dict.fromkeys(key for row in rows for key in row))
    body = [[row.get(c) for c in columns] for row in rows]
    where = f"wrote {result['path']}" if "path" in result else ""
    return _join(_title(result), _section("Quality on unseen points", body, columns), where)


def interaction_text(result: Result) -> str:
    """Tables 2 and 3 beside the paper's, what differs from it much, and the parts of the derivatives."""
    units = {"L_over_D": "", "thrust": "N", "change": "%"}
    rows = [
        (row["case"], name, row["ours"][name], row["paper"].get(name), _kind_unit(name, units))
        for row in [*result.get("table2", ()), *result.get("table3", ())]
        for name in row["ours"]
    ]
    far = [
        (f"Table {d['table']}, {d['case']}", d["quantity"], d["ours"], d["paper"], f"{d['ratio']:.2f}")
        for d in result.get("differences", ())
    ]
    shares = [
        _parts(state[key], f"{title} at {state['alpha']:g} deg")
        for state in result.get("split", ())
        for key, title in (("power_on", "Parts, power on"), ("slipstream", "Added by the slipstreams"))
    ]
    figures = result.get("figures")
    return _join(
        _title(result),
        _section("Tables 2 and 3, slopes per degree", rows, ("", "", "ours", "paper", "unit")),
        _section("Beyond a factor of 1.5, or of another sign", far, ("", "", "ours", "paper", "ours/paper")),
        *shares,
        f"wrote {', '.join(figures)}" if figures else "",
    )


def _kind_unit(name: str, units: Mapping[str, str]) -> str:
    """Unit of a row: of its last word that has one, else that of a slope."""
    return next((units[k] for k in ("change", "thrust", "L_over_D") if k in name), "1/deg")


def _parts(parts: Any, title: str = "Parts") -> str:
    """Longitudinal coefficients of each part and their derivatives by incidence."""
    columns = ("CX", "CZ", "Cm", "CX_alpha", "CZ_alpha", "Cm_alpha")
    if not isinstance(parts, Mapping) or not all(c in values for values in parts.values() for c in columns):
        return ""
    body = [[name, *(_figure(values[c], 5) for c in columns)] for name, values in parts.items()]
    return _section(f"{title} (derivatives per radian)", body, ("", *columns))


def saturated_names(result: Result) -> list[str]:
    """Controls at their bounds."""
    return [str(name) for name in result.get("saturated") or ()]


def violated_constraints(result: Result) -> list[tuple[str, Result, str]]:
    """Name, entries and requirement of each constraint marked as violated or with a negative margin."""
    found = []
    for name, row in result.get("constraints", {}).items():
        row = row if isinstance(row, Mapping) else {"value": row}
        margin = row.get("margin")
        if row.get("violated", margin is not None and margin < 0):
            found.append((str(name), row, _requirement(row)))
    return found


def _analysis(values: Result, units: Mapping[str, Any]) -> list[str]:
    """The sections of one analysed condition."""
    inputs = [n for n in values if n in _CONDITION or (n.startswith("theta_") and n != "theta_tip")]
    return [
        _quantities("Condition", inputs, values, units),
        _quantities("Forces and moments", _FORCES, values, units),
        _stall(values),
        _drag(values),
        _derivatives(values),
        _parts(values.get("parts")),
        _rotors(values, units),
        _quantities("Stability", _STABILITY, values, units),
        _quantities("Mass and structure", _MASS, values, units),
        _quantities("Range", _RANGE, values, units),
    ]


def _quantities(title: str, names: Iterable[str], values: Result, units: Mapping[str, Any]) -> str:
    """Scalars by name with their units."""
    rows = [(n, values[n], _unit(n, units)) for n in names if n in values and _is_scalar(values[n])]
    return _section(title, rows)


def _stall(values: Result) -> str:
    """A warning where section lift has left its polar."""
    margin = values.get("lift_margin")
    if not isinstance(margin, float) or margin >= 0.0:
        return ""
    where = ""
    if "stall_y" in values:
        where = f" at y = {values['stall_y']:.2f} m of lifting surface {values['stall_surface']:.0f}"
    return f"STALLED: section lift{where} is {-margin:.2f} beyond its polar; the lattice goes on as if it were attached"


def _drag(values: Result) -> str:
    """Drag build-up in counts and in parts of the whole."""
    rows = [(n, values[n]) for n in _DRAG if _is_number(values.get(n))]
    total = values.get("CD")
    share = _is_number(total) and total
    body = [(n, f"{_COUNTS * v:.1f}", f"{100 * v / total:.1f}" if share else "") for n, v in rows]
    return _section("Drag", body, ("", "counts", "%"))


def _derivatives(values: Result) -> str:
    """Matrix of derivatives: a coefficient a row, what it is derived by a column."""
    found = {(m["row"], m["by"]): v for n, v in values.items() if (m := _DERIVATIVE.fullmatch(n))}
    present = dict.fromkeys(by for _, by in found)
    columns = [by for by in _BY if by in present] + [by for by in present if by not in _BY]
    rows = [c for c in _COEFFICIENTS if any(row == c for row, _ in found)]
    body = [[row, *(_figure(found.get((row, by)), 5) for by in columns)] for row in rows]
    return _section("Derivatives (angles per radian, rates per unit of the dimensionless rate)", body, ["", *columns])


def _rotors(values: Result, units: Mapping[str, Any]) -> str:
    """One rotor of each group."""
    groups = [n.removeprefix("thrust_") for n in values if n.startswith("thrust_")]
    kinds = [k for k in _ROTOR if any(f"{k}_{g}" in values for g in groups)]
    head = ["group"] + [f"{k} [{u}]" if groups and (u := _unit(f"{k}_{groups[0]}", units)) else k for k in kinds]
    return _section("Rotors, one of each group", [[g, *(values.get(f"{k}_{g}") for k in kinds)] for g in groups], head)


def _trim_state(result: Result) -> list[tuple[Any, ...]]:
    """Unknowns of the trim with unit, bounds and a mark at a bound."""
    values, bounds, units = result.get("values", {}), result.get("bounds", {}), _units(result)
    saturated = saturated_names(result)
    names = list(bounds) or [n for n in values if n in ("alpha", "delta_e") or n.startswith("theta_")]
    names = [n for n in names if n != "theta_tip"]
    names += [n for n in saturated if n not in names]
    rows = []
    for name in names:
        lower, upper = bounds.get(name, (None, None))
        mark = "at its bound" if name in saturated else ""
        rows.append((name, values.get(name), _unit(name, units), lower, upper, mark))
    return rows


def _records(title: str, entries: Any) -> str:
    """A dictionary of figures, or of dictionaries with like keys, as one table."""
    if not isinstance(entries, Mapping) or not entries:
        return ""
    records = {n: e if isinstance(e, Mapping) else {"value": e} for n, e in entries.items()}
    columns = list(dict.fromkeys(key for record in records.values() for key in record))
    return _section(title, [[n, *(r.get(c) for c in columns)] for n, r in records.items()], ["", *columns])


def _without_reasons(constraints: Any) -> Any:
    """Constraints without the text that says where each comes from: the report has it."""
    if not isinstance(constraints, Mapping):
        return constraints
    return {
        n: {k: v for k, v in row.items() if k != "reason"} if isinstance(row, Mapping) else row
        for n, row in constraints.items()
    }


def _requirement(row: Result) -> str:
    """The bounds of a constraint in words."""
    if row.get("equals") is not None:
        return f"= {_figure(row['equals'])}"
    sides = ((">=", row.get("lower")), ("<=", row.get("upper")))
    text = " and ".join(f"{sign} {_figure(bound)}" for sign, bound in sides if bound is not None)
    return text or "a margin >= 0"


def _title(result: Result) -> str:
    """Name of the aircraft and the start of its hash."""
    return f"{result.get('aircraft', 'result')} {str(result.get('hash', ''))[:12]}".rstrip()


def _section(title: str, rows: Sequence[Sequence[Any]], head: Sequence[str] = ()) -> str:
    """A titled table, or nothing."""
    return f"{title}\n{grid(rows, head)}" if rows else ""


def _join(*blocks: str) -> str:
    """Blocks with a blank line between them."""
    return "\n\n".join(block for block in blocks if block)


def _ordered(values: Result) -> list[str]:
    """Names in the order of the registry, what it does not list behind."""
    known = [*INPUTS, *OUTPUTS]
    return [n for n in known if n in values] + [n for n in values if n not in known]


def _units(result: Result) -> Mapping[str, Any]:
    """Units that the result brings along."""
    units = result.get("units")
    return units if isinstance(units, Mapping) else {}


def _unit(name: str, units: Mapping[str, Any]) -> str:
    """Unit of a variable; empty for a dimensionless one."""
    if name in units:
        return str(units[name] or "")
    try:
        return quantity(name).units or ""
    except KeyError:
        return ""


def _change(before: Any, after: Any) -> str:
    """Change in percent of the baseline."""
    if not (_is_number(before) and _is_number(after)) or before == 0:
        return ""
    return f"{100 * (after - before) / abs(before):+.2f}"


def _counted(names: Sequence[str]) -> str:
    """How many, and which."""
    return f"{len(names)} ({', '.join(names)})" if names else "0"


def _is_number(value: Any) -> bool:
    """Whether a value is a finite number."""
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def _is_scalar(value: Any) -> bool:
    """Whether a value fits in a cell."""
    return value is None or isinstance(value, int | float | str)


def _is_figure(text: str) -> bool:
    """Whether a cell holds a number."""
    return bool(re.match(r"[-+]?\d", text))


ROUNDING = 1e-13
"""What symmetry leaves of a number that is zero; tables show nothing smaller."""


def _figure(value: Any, digits: int = 6) -> str:
    """A number with so many digits; a dash where there is none."""
    if value is None or not isinstance(value, int | float) or isinstance(value, bool):
        return "-"
    return "0" if abs(value) < ROUNDING else f"{value:.{digits}g}"


def _cell(value: Any) -> str:
    """Text of a cell."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if value is None or isinstance(value, int | float):
        return _figure(value)
    if isinstance(value, list | tuple):
        return " ".join(_cell(v) for v in value)
    return str(value)
