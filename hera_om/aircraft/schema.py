"""The schema as a page: every key with its unit, range, default and meaning."""

import re

from hera_om.aircraft.definition import Aircraft
from hera_om.aircraft.fields import Key, Part, keys_of, tables_of

_UNIT = re.compile(r"^(?P<meaning>.*) \[(?P<unit>[^\]]*)\]$", re.DOTALL)


def schema_markdown() -> str:
    """Markdown with one table of keys for each table of a definition, in the order of the schema."""
    return "\n".join(_section(*entry) for entry in tables_of(Aircraft))


def _section(path: str, part: type[Part], in_array: bool) -> str:
    """Heading, purpose and keys of one table."""
    heading = f"`[[{path}]]`" if in_array else f"`[{path}]`" if path else "Top level"
    purpose = re.sub(r"\s*\n\s*", " ", (part.__doc__ or "").strip())
    rows = [_row(key) for key in keys_of(part).values()]
    head = ["| key | unit | accepts | default | meaning |", "|---|---|---|---|---|"]
    return "\n".join([f"### {heading}", "", purpose, "", *head, *rows, ""])


def _row(key: Key) -> str:
    """One key."""
    found = _UNIT.match(key.description)
    meaning, unit = (found["meaning"], found["unit"]) if found else (key.description, "")
    cells = [f"`{key.name}`", unit, _accepts(key), _default(key), meaning]
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |"


def _accepts(key: Key) -> str:
    """Type and range of a key."""
    if key.kind == "choice":
        return ", ".join(f"`{choice}`" for choice in key.choices)
    names = {"switch": "true or false", "tables": "array of tables", "numbers": "array", "constants": "array"}
    noun = (names | {"constant": "number"}).get(key.kind, key.kind)
    return f"{noun} {key.range_text()}".rstrip()


def _default(key: Key) -> str:
    """Default of a key; a table or array that may be absent is optional."""
    if key.required:
        return "required"
    if key.default is None or key.part is not None:
        return "optional"
    text = str(key.default).lower() if isinstance(key.default, bool) else f"{key.default}"
    return f"`{text}`" if text else "empty"
