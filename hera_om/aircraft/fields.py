"""What the keys of a definition share: the strict base class, field makers, and a view of the schema."""

import types
import typing
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import Any, Literal

import annotated_types as at
from pydantic import BaseModel, ConfigDict, Field
from pydantic.fields import FieldInfo

NAME = r"^[A-Za-z][A-Za-z0-9_-]*$"  # stands in a dotted path
IDENTIFIER = r"^[A-Za-z][A-Za-z0-9_]*$"  # stands also in a variable's name, such as theta_<rotor>
NAME_TEXT = {
    NAME: "a letter, then letters, digits, _ or -",
    IDENTIFIER: "a letter, then letters, digits or _",
}

Kind = Literal["number", "integer", "switch", "text", "choice", "numbers", "constant", "constants", "table", "tables"]


class Constant:
    """Marks what is structure, not a number with a path, such as coordinates of an airfoil."""


class Part(BaseModel):
    """Base of every table: strict types, no unknown keys, finite numbers, immutable, hashable."""

    model_config = ConfigDict(strict=True, frozen=True, extra="forbid", allow_inf_nan=False)


def number(meaning: str, unit: str = "", default: Any = ..., **limits: float) -> Any:
    """A field for a number: its meaning, its unit (empty: dimensionless) and its range as gt, ge, lt, le."""
    return Field(default, description=f"{meaning} [{unit or '-'}]", **limits)  # type: ignore[arg-type]


def item(meaning: str, default: Any = ..., pattern: str | None = None) -> Any:
    """A field for what is not a number: text, a switch, a table, an array of tables."""
    return Field(default, description=meaning, pattern=pattern)


@dataclass(frozen=True)
class Key:
    """One key of a table: its kind and range (of the element, for an array) and, for a table, its class."""

    name: str
    kind: Kind
    optional: bool
    part: type[Part] | None
    choices: tuple[str, ...]
    description: str
    default: Any
    required: bool
    metadata: tuple[Any, ...]

    def limits(self) -> tuple[tuple[str, float], ...]:
        """The range of a number as pairs of a relation and a bound."""
        found = []
        for m in self.metadata:
            for attr, sign in (("gt", ">"), ("ge", ">="), ("lt", "<"), ("le", "<=")):
                if isinstance(m, at.Gt | at.Ge | at.Lt | at.Le) and hasattr(m, attr):
                    found.append((sign, float(getattr(m, attr))))
        return tuple(found)

    def admits(self, value: float) -> bool:
        """Whether a number lies in the key's range."""
        tests = {
            ">": value.__gt__,
            ">=": value.__ge__,
            "<": value.__lt__,
            "<=": value.__le__,
        }
        return all(tests[sign](bound) for sign, bound in self.limits())

    def range_text(self) -> str:
        """The range in words, such as ``> 0 and <= 1``; empty when every value goes."""
        return " and ".join(f"{sign} {bound:g}" for sign, bound in self.limits())

    def pattern(self) -> str | None:
        """The regular expression that a text must match."""
        return next((p for m in self.metadata if (p := getattr(m, "pattern", None))), None)


@cache
def keys_of(part: type[Part]) -> dict[str, Key]:
    """The keys of a table in the order of the schema."""
    return {name: _key(name, info) for name, info in part.model_fields.items()}


def key_at(part: type[Part], path: str) -> Key | None:
    """The key that a dotted path leads to, names of array items being free; None when there is none."""
    segments = iter(path.split("."))
    found: Key | None = None
    for segment in segments:
        found = keys_of(part).get(segment)
        if found is None or (found.kind in ("tables", "numbers") and next(segments, None) is None):
            return None
        if found.part is None:
            return found if next(segments, None) is None else None
        part = found.part
    return found


def tables_of(part: type[Part], path: str = "", in_array: bool = False) -> Iterator[tuple[str, type[Part], bool]]:
    """Every table of the schema, depth first: its path, its class, whether it is one of an array."""
    yield path, part, in_array
    for key in keys_of(part).values():
        if key.part is not None:
            yield from tables_of(key.part, f"{path}.{key.name}".lstrip("."), key.kind == "tables")


def _key(name: str, info: FieldInfo) -> Key:
    """Classify a field by its annotation."""
    annotation, metadata, optional = info.annotation, list(info.metadata), False
    if typing.get_origin(annotation) in (typing.Union, types.UnionType):
        inner = [a for a in typing.get_args(annotation) if a is not types.NoneType]
        optional = len(inner) < len(typing.get_args(annotation))
        annotation = inner[0]
    in_tuple = typing.get_origin(annotation) is tuple
    if in_tuple:
        annotation = typing.get_args(annotation)[0]
        if typing.get_origin(annotation) is typing.Annotated:
            annotation, *extra = typing.get_args(annotation)
            metadata += [m for e in extra for m in (e.metadata if isinstance(e, FieldInfo) else [e])]
    choices = typing.get_args(annotation) if typing.get_origin(annotation) is Literal else ()
    part = annotation if isinstance(annotation, type) and issubclass(annotation, Part) else None
    return Key(
        name=name,
        kind=_constant(in_tuple) if Constant in metadata else _kind(annotation, part, in_tuple, bool(choices)),
        optional=optional,
        part=part,
        choices=choices,
        description=info.description or "",
        default=info.default,
        required=info.is_required(),
        metadata=tuple(metadata),
    )


def _constant(in_tuple: bool) -> Kind:
    """The kind of what is structure."""
    return "constants" if in_tuple else "constant"


def _kind(annotation: Any, part: type[Part] | None, in_tuple: bool, has_choices: bool) -> Kind:
    """The kind of one annotation."""
    if part is not None:
        return "tables" if in_tuple else "table"
    if in_tuple:
        return "numbers"
    if has_choices:
        return "choice"
    simple: dict[Any, Kind] = {float: "number", int: "integer", bool: "switch", str: "text"}
    return simple[annotation]
