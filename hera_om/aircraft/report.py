"""Turn what pydantic finds into problems that name file, key, value and what was expected."""

import re
from collections.abc import Mapping
from typing import Any

from pydantic import ValidationError

from hera_om.aircraft.definition import Aircraft
from hera_om.aircraft.fields import NAME_TEXT, Key, Part, keys_of
from hera_om.aircraft.masses import TRACKS
from hera_om.aircraft.paths import suggest
from hera_om.aircraft.spacing import LAW, LAW_TEXT
from hera_om.aircraft.surfaces import AIRFOIL, AIRFOIL_TEXT
from hera_om.core.errors import Problem

_INDEX = re.compile(r"\[\d+\]")
_PATTERNS = NAME_TEXT | {
    AIRFOIL: AIRFOIL_TEXT,
    LAW: LAW_TEXT,
    TRACKS: "'wing', 'htail', 'vtail', 'fuel' or 'rotor:<group>'",
}


def problems_of(error: ValidationError, data: Mapping[str, Any], file: str) -> list[Problem]:
    """Every fault of one validation, in the order of the schema."""
    found = [dict(e) for e in error.errors(include_url=False)]
    return [_problem(e, data, file) for e in found if not _follows(e)]


def expectation(key: Key, path: str) -> str:
    """What the key at a path accepts, in words."""
    path = _INDEX.sub("", path)
    heading = {
        "table": f"a table [{path}]",
        "tables": f"an array of tables [[{path}]]",
        "switch": "true or false",
    }
    if key.kind in heading:
        text = heading[key.kind]
    elif key.kind == "choice":
        text = " or ".join(repr(c) for c in key.choices)
    elif key.kind == "text":
        text = _PATTERNS.get(key.pattern() or "", "a text")
    else:
        nouns = {"number": "a finite number", "constant": "a finite number", "integer": "an integer"}
        text = f"{nouns.get(key.kind, 'an array of finite numbers')} {key.range_text()}".rstrip()
    return f"{text}: {key.description}"


def shallow(value: Any) -> Any:
    """A value fit for a report: scalars as they are, containers by their size."""
    if isinstance(value, Mapping):
        return "a table"
    if isinstance(value, list | tuple):
        return f"an array of {len(value)}"
    if isinstance(value, int) and not isinstance(value, bool) and abs(value) > 10**30:
        return "an integer of more than 30 digits"
    return value if value is None or isinstance(value, str | int | float | bool) else str(value)


def _follows(error: dict[str, Any]) -> bool:
    """Whether an array counts as too short only because pydantic leaves out its faulty entries."""
    return error["type"] == "too_short" and len(error["input"]) >= error["ctx"]["min_length"]


def _problem(error: dict[str, Any], data: Mapping[str, Any], file: str) -> Problem:
    """One fault."""
    path, table, key = _locate(error["loc"], data)
    if error["type"] == "extra_forbidden":
        known = list(keys_of(table))
        expected = f"no such key{suggest(str(error['loc'][-1]), known)} (known keys: {', '.join(known)})"
    elif key is None:
        expected = error["msg"]
    elif error["type"] == "too_short":
        expected = f"at least {error['ctx']['min_length']} entries: {key.description}"
    elif error["type"] == "string_too_short":
        expected = f"a text that is not empty: {key.description}"
    elif key.kind in ("tables", "table") and error["loc"][-1] != key.name:
        expected = f"a table [[{_INDEX.sub('', path)}]]"
    else:
        expected = expectation(key, path)
    value = None if error["type"] == "missing" else shallow(error["input"])
    return Problem(file, path, value, expected)


def _locate(loc: tuple[int | str, ...], data: Any) -> tuple[str, type[Part], Key | None]:
    """Dotted path of a location, the class of the table it is in, and its key when the schema has it."""
    table: type[Part] = Aircraft
    key: Key | None = None
    path, node = "", data
    for depth, step in enumerate(loc):
        node = _step(node, step)
        if isinstance(step, int):
            in_tables = key is not None and key.kind == "tables"
            path += _label(node, step) if in_tables else f".{step}"
            continue
        if depth and key is not None and key.part is not None:
            table = key.part
        key = keys_of(table).get(step)
        path += f".{step}" if path else step
    return path, table, key


def _step(node: Any, step: int | str) -> Any:
    """The child of a node, or None."""
    try:
        return node[step]
    except (KeyError, IndexError, TypeError):
        return None


def _label(node: Any, index: int) -> str:
    """How a path names an item of an array of tables: by its name, else by its place."""
    name = node.get("name") if isinstance(node, Mapping) else None
    return f".{name}" if isinstance(name, str) and name else f"[{index}]"
