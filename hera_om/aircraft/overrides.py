"""Put a value into the raw tables of a definition by its dotted path, before validation."""

from collections.abc import Iterator, Mapping
from typing import Any

from hera_om.aircraft.definition import Aircraft
from hera_om.aircraft.fields import Part, keys_of
from hera_om.aircraft.paths import suggest


def apply_override(data: dict[str, Any], path: str, value: Any) -> str | None:
    """Write a value into the raw tables; an absent key or optional table is added.

    Returns:
        None when done, else what was expected of the path, in words.
    """
    node: Any = data
    table: type[Part] = Aircraft
    segments = path.split(".")
    while segments:
        key = keys_of(table).get(segments[0])
        segments = segments[1:]
        if key is None or not isinstance(node, dict):
            break
        if key.kind in ("number", "integer") and not segments:
            node[key.name] = int(value) if key.kind == "integer" and _whole(value) else value
            return None
        if key.kind == "numbers" and len(segments) == 1:
            missing = _set_element(node.get(key.name), segments[0], value)
            return _unknown(data, path) if missing else None
        if key.part is None:
            break
        table = key.part
        if key.kind == "table":
            node = node.setdefault(key.name, {})
        elif segments:
            node, segments = _named(node.get(key.name), segments[0]), segments[1:]
    return _unknown(data, path)


def _whole(value: Any) -> bool:
    """Whether a float stands for an integer."""
    return isinstance(value, float) and value.is_integer()


def _named(items: Any, name: str) -> Any:
    """The table of an array that has a name, or None."""
    if not isinstance(items, list):
        return None
    return next((i for i in items if isinstance(i, dict) and i.get("name") == name), None)


def _set_element(values: Any, index: str, value: Any) -> bool:
    """Set an element of an array; True when there is none such."""
    if not isinstance(values, list) or not index.isdecimal() or int(index) >= len(values):
        return True
    values[int(index)] = value
    return False


def _unknown(data: dict[str, Any], path: str) -> str:
    """What to say of a path that leads nowhere."""
    return f"the path of a number in this definition{suggest(path, list(_settable(Aircraft, data, '')))}"


def _settable(table: type[Part], node: Any, prefix: str) -> Iterator[str]:
    """Every path that can be set."""
    node = node if isinstance(node, Mapping) else {}
    for name, key in keys_of(table).items():
        child = node.get(name)
        if key.kind in ("number", "integer"):
            yield prefix + name
        elif key.kind == "numbers" and isinstance(child, list):
            yield from (f"{prefix}{name}.{i}" for i in range(len(child)))
        elif key.kind == "table" and key.part is not None:
            yield from _settable(key.part, child, f"{prefix}{name}.")
        elif key.kind == "tables" and key.part is not None and isinstance(child, list):
            for entry in child:
                if isinstance(entry, Mapping) and "name" in entry:
                    yield from _settable(key.part, entry, f"{prefix}{name}.{entry.get('name')}.")
