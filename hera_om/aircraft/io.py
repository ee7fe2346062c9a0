"""Load, check, write and hash a definition."""

import hashlib
import json
import tomllib
from collections.abc import Mapping
from importlib import resources
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from hera_om.aircraft.airfoils import copy_airfoil_files
from hera_om.aircraft.avl_read import avl_tables
from hera_om.aircraft.checks import find_problems
from hera_om.aircraft.definition import Aircraft
from hera_om.aircraft.fields import Part, keys_of
from hera_om.aircraft.overrides import apply_override
from hera_om.aircraft.paths import suggest
from hera_om.aircraft.polars import load_polar_tables
from hera_om.aircraft.report import problems_of, shallow
from hera_om.aircraft.structure import shipped_materials
from hera_om.core.errors import InputError, Problem

OVERRIDE = "override"  # stands for the file in a problem of an overriding value


def shipped() -> tuple[str, ...]:
    """Names of the aircraft that come with the package."""
    files = (resources.files("hera_om.aircraft") / "data").iterdir()
    names = (f.name.removesuffix(".toml") for f in files if f.name.endswith(".toml"))
    return tuple(sorted(n for n in names if n != "materials"))


def load_aircraft(source: str | Path, overrides: Mapping[str, float] | None = None) -> Aircraft:
    """Load a definition and check it.

    Args:
        source: name of a shipped aircraft, or the path of a TOML file or of an AVL geometry file (.avl).
        overrides: values by dotted path that replace those of the file; an integer key takes a whole number.

    Raises:
        InputError: with every fault of the file and of the overrides.
    """
    name = str(source)
    if name in shipped():
        file = f"{name}.toml"
        raw = (resources.files("hera_om.aircraft") / "data" / file).read_bytes()
    else:
        file, raw = name, _read(name)
    text = _decode(raw, file)
    if file.lower().endswith(".avl"):
        return _checked(avl_tables(text, file), file, overrides or {})
    return _build(text, file, overrides or {})


def read_avl(path: str | Path) -> Aircraft:
    """Read an AVL geometry file, whatever its ending; see `avl_read` for signs and for what is left out.

    Raises:
        InputError: with every fault.
    """
    file = str(path)
    return _checked(avl_tables(_decode(_read(file), file), file), file, {})


def raw_tables(source: str | Path) -> dict[str, Any]:
    """The tables of a definition before any check, an AVL file's included.

    Raises:
        InputError: it cannot be read as TOML or as an AVL file.
    """
    name = str(source)
    if name in shipped():
        return _parse((resources.files("hera_om.aircraft") / "data" / f"{name}.toml").read_text("utf-8"), name)
    text = _decode(_read(name), name)
    return avl_tables(text, name) if name.lower().endswith(".avl") else _parse(text, name)


def loads(text: str, file: str = "<text>") -> Aircraft:
    """Read a definition from TOML text and check it; ``file`` is what a report calls it.

    Raises:
        InputError: with every fault.
    """
    return _build(text, file, {})


def dumps(aircraft: Aircraft) -> str:
    """The definition as TOML, defaults written out; ``loads`` gives an equal aircraft back."""
    import tomli_w

    return tomli_w.dumps(_plain(aircraft))


def definition_hash(aircraft: Aircraft) -> str:
    """SHA-256 of the canonical form: JSON of every key that is present, keys sorted, shortest float text."""
    text = json.dumps(_plain(aircraft), sort_keys=True, separators=(",", ":"), allow_nan=False)
    return hashlib.sha256(text.encode("ascii")).hexdigest()


def _build(text: str, file: str, overrides: Mapping[str, float]) -> Aircraft:
    """Text to a checked aircraft; each stage reports all its faults."""
    return _checked(_parse(text, file), file, overrides)


def _checked(data: dict[str, Any], file: str, overrides: Mapping[str, float]) -> Aircraft:
    """Raw tables to a checked aircraft."""
    _add_shipped_material(data)
    problems = copy_airfoil_files(data, file)
    for path, value in overrides.items():
        expected = apply_override(data, path, value)
        if expected:
            problems.append(Problem(OVERRIDE, path, shallow(value), expected))
    problems += load_polar_tables(data, Path(file).parent, file)
    data = _tuples(data)
    try:
        aircraft = Aircraft.model_validate(data)
    except ValidationError as error:
        problems += problems_of(error, data, file)
    else:
        problems += find_problems(aircraft, file)
    if problems:
        raise InputError(_relabel(p, overrides) for p in problems)
    return aircraft


def _relabel(problem: Problem, overrides: Mapping[str, float]) -> Problem:
    """Blame the override, not the file, for a value that came from one."""
    if problem.key in overrides:
        return Problem(OVERRIDE, problem.key, problem.value, problem.expected)
    return problem


def _read(name: str) -> bytes:
    """The bytes of a file, or the one problem that keeps it from being read."""
    path = Path(name)
    known = f"; shipped aircraft: {', '.join(shipped())}"
    try:
        if not name:
            raise InputError([Problem("''", "", "an empty name", f"a TOML file{known}")])
        if path.is_dir():
            raise InputError([Problem(name, "", "a folder", f"a TOML file{known}")])
        if not path.exists():
            raise InputError(
                [
                    Problem(
                        name,
                        "",
                        "no such file",
                        f"a TOML file or a shipped aircraft{suggest(name, shipped())}{known}",
                    )
                ]
            )
        if not path.is_file():
            raise InputError([Problem(name, "", "a device or pipe", f"a TOML file{known}")])
        return path.read_bytes()
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError([Problem(name, "", reason, "a TOML file that can be read")]) from None


def _decode(raw: bytes, file: str) -> str:
    """UTF-8 text, with or without a byte order mark."""
    if b"\0" in raw:
        raise InputError([Problem(file, "", f"a binary file (NUL at byte {raw.index(0)})", "TOML text in UTF-8")])
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        got = f"a binary file (byte {error.start} is not UTF-8)"
        raise InputError([Problem(file, "", got, "TOML text in UTF-8")]) from None


def _parse(text: str, file: str) -> dict[str, Any]:
    """TOML to dictionaries and lists."""
    try:
        text.encode("utf-8")  # lone surrogates would break every later writer
        data = tomllib.loads(text)
        _tuples(data)  # nesting too deep for us shows here
    except RecursionError:
        raise InputError([Problem(file, "", "tables nested too deeply", "a definition in TOML")]) from None
    except ValueError as error:  # tomllib's own error, and what int() says of a number of thousands of digits
        raise InputError([Problem(file, "", f"broken TOML: {error}", "a definition in TOML")]) from None
    if not data:
        raise InputError([Problem(file, "", "an empty file", "a definition in TOML with at least name and [flight]")])
    return data


def _add_shipped_material(data: dict[str, Any]) -> None:
    """Copy the shipped material that the wing box names into the definition, unless it has its own."""
    wing = data.get("wing")
    structure = wing.get("structure") if isinstance(wing, dict) else None
    wanted = structure.get("material") if isinstance(structure, dict) else None
    own = [data.get(kind, []) for kind in ("material", "laminate")]
    if not isinstance(wanted, str) or wanted not in shipped_materials() or not all(isinstance(o, list) for o in own):
        return
    if not any(isinstance(m, dict) and m.get("name") == wanted for tables in own for m in tables):
        kind, table = shipped_materials()[wanted]
        data[kind] = [*data.get(kind, []), dict(table)]


def _tuples(value: Any) -> Any:
    """Lists to tuples, all the way down."""
    if isinstance(value, dict):
        return {k: _tuples(v) for k, v in value.items()}
    return tuple(_tuples(v) for v in value) if isinstance(value, list) else value


def _plain(part: Part) -> dict[str, Any]:
    """A part as dictionaries, lists and scalars, without what is absent; -0.0 becomes 0.0."""
    plain: dict[str, Any] = {}
    for name, key in keys_of(type(part)).items():
        value = getattr(part, name)
        if value is None or (key.kind == "tables" and not value):
            continue
        if key.kind in ("number", "constant"):
            value = float(value) + 0.0
        elif key.kind in ("numbers", "constants"):
            value = [float(v) + 0.0 for v in value]
        elif key.kind == "table":
            value = _plain(value)
        elif key.kind == "tables":
            value = [_plain(entry) for entry in value]
        plain[name] = value
    return plain
