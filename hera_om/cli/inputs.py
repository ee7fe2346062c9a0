"""From arguments to a checked aircraft: options, files and ``--set``, with every fault in one report."""

import argparse
import math
import os
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from hera_om.aircraft import Aircraft, load_aircraft, raw_tables
from hera_om.aircraft.io import OVERRIDE
from hera_om.aircraft.paths import suggest
from hera_om.cli.parser import COMMAND_LINE
from hera_om.core.errors import InputError, Problem
from hera_om.core.registry import OUTPUTS

FLIGHT = {
    "alpha": "flight.alpha_deg",
    "beta": "flight.beta_deg",
    "mach": "flight.mach",
    "altitude": "flight.altitude_m",
    "p_hat": "flight.p_hat",
    "q_hat": "flight.q_hat",
    "r_hat": "flight.r_hat",
    "delta_e": "flight.delta_e_deg",
    "delta_a": "flight.delta_a_deg",
    "delta_r": "flight.delta_r_deg",
    "delta_f": "flight.delta_f_deg",
}
"""Registry inputs that are numbers of the definition in the same unit, and their paths."""

_NUMBERS: dict[str, tuple[type, float, float, str]] = {  # option -> type, least, most, expected
    "load_factor": (float, -20.0, 20.0, "a finite number from -20 to 20"),
    "max_iterations": (int, 1, 10**9, "an integer >= 1"),
    "samples": (int, 10, 10**6, "an integer from 10 to 1000000"),
    "seed": (int, 0, 2**32 - 1, "an integer from 0 to 4294967295"),
}
_TARGETS = {  # option of a file that is written -> ending that is required, first bytes, what it is
    "db": ("", b"SQLite format 3\0", "the database of a run"),
    "out": (".npz", b"PK\x03\x04", "a file of surrogates"),
}


def prepare(args: argparse.Namespace) -> Aircraft:
    """Check every option and load the aircraft with its changed numbers.

    ``args`` is completed in place: options become numbers, ``aero`` becomes "lattice" or a path.

    Raises:
        InputError: with every fault of options, files, assignments and definition.
    """
    tables = _tables(args.aircraft)
    if "out" in args and args.out is None:
        args.out = _surrogate_file(args.aircraft, tables)
    problems = [*_option_problems(args), *_target_problems(args), *_aero_problems(args, tables)]
    overrides, names, unresolved = _assignments(args.assignments, tables)
    problems += unresolved
    try:
        aircraft = load_aircraft(args.aircraft, overrides)
    except InputError as error:
        raise InputError([*problems, *(_relabel(p, names) for p in error.problems)]) from None
    if problems:
        raise InputError(problems)
    return aircraft


def record_file(name: str) -> Path:
    """The database that a report is made of.

    Raises:
        InputError: it is missing, a folder, empty or no database.
    """
    ours = "the database of a run, such as 'hera-om mdo' writes"
    path = Path(name)
    try:
        if path.exists() and not path.is_file():
            raise InputError([Problem(name, "", "a folder" if path.is_dir() else "a device or pipe", ours)])
        with path.open("rb") as stream:
            start = stream.read(16)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        raise InputError([Problem(name, "", reason.lower(), ours)]) from None
    if start != _TARGETS["db"][1]:
        raise InputError([Problem(name, "", "no database" if start else "an empty file", ours)])
    return path


def page_file(name: str | None, database: Path) -> Path:
    """The page that a report writes; it must not replace a database.

    Raises:
        InputError: it cannot be written there.
    """
    path = database.with_suffix(".html") if name is None else Path(name)
    problems = list(_place_problems("--out", str(path), "", b"<", "a page of HTML"))
    if problems:
        raise InputError(problems)
    return path


def _tables(source: str) -> dict[str, Any]:
    """The definition before any check; empty when it cannot be read, which loading reports better."""
    try:
        return raw_tables(source)
    except InputError:
        return {}


def _surrogate_file(source: str, tables: Mapping[str, Any]) -> str:
    """Default file of an aircraft's surrogate, in the current folder."""
    name = tables.get("name")
    stem = name if isinstance(name, str) and name else Path(source).stem
    return re.sub(r"[^\w.-]+", "_", stem) + "_surrogate.npz"


def _option_problems(args: argparse.Namespace) -> Iterator[Problem]:
    """Turn the numeric options into numbers, or say what is wrong with them."""
    for option, (kind, least, most, expected) in _NUMBERS.items():
        text = getattr(args, option, None)
        if text is None:
            continue
        try:
            value = kind(text)
        except ValueError:
            value = math.nan
        if not least <= value <= most:
            yield Problem(COMMAND_LINE, f"--{option.replace('_', '-')}", text, expected)
        setattr(args, option, value)


def _target_problems(args: argparse.Namespace) -> Iterator[Problem]:
    """What keeps the files of the run from being written."""
    for option, target in _TARGETS.items():
        if getattr(args, option, None) is not None:
            yield from _place_problems(f"--{option}", getattr(args, option), *target)


def _place_problems(option: str, name: str, ending: str, magic: bytes, what: str) -> Iterator[Problem]:
    """Faults of a file that is to be written: no place for it, or something else stands there."""
    path = Path(name)
    try:
        if not name or (path.exists() and not path.is_file()):
            yield Problem(COMMAND_LINE, option, name, f"the name of a file for {what}, no folder or device")
        elif ending and path.suffix.lower() != ending:
            yield Problem(COMMAND_LINE, option, name, f"the name of a file that ends in {ending}")
        elif not path.parent.is_dir() or not os.access(path.parent, os.W_OK):
            yield Problem(COMMAND_LINE, option, name, "a file in a folder that exists and can be written")
        elif path.exists() and not _is_ours(path, magic):
            yield Problem(COMMAND_LINE, option, name, f"a new file or {what} to replace; this is another file")
    except (OSError, ValueError) as error:
        yield Problem(COMMAND_LINE, option, name, f"a file that can be written ({error})")


def _is_ours(path: Path, magic: bytes) -> bool:
    """Whether a file may be replaced: it is empty or starts as ours do."""
    with path.open("rb") as stream:
        start = stream.read(len(magic))
    return start in (b"", magic)


def _aero_problems(args: argparse.Namespace, tables: Mapping[str, Any]) -> Iterator[Problem]:
    """Turn ``--aero`` and ``--surrogate`` into "lattice" or an existing path."""
    if "aero" not in args:
        return
    if args.surrogate is not None and args.aero != "surrogate":
        expected = f"no such option beside --aero {args.aero}: it goes with --aero surrogate"
        yield Problem(COMMAND_LINE, "--surrogate", args.surrogate, expected)
    if args.aero == "lattice":
        return
    by_name = args.aero == "surrogate"
    file = (args.surrogate or _surrogate_file(args.aircraft, tables)) if by_name else args.aero
    if not file or not Path(file).exists():
        made = f"a file that 'hera-om train {args.aircraft} --out FILE' has written"
        hint = suggest(args.aero, ("lattice", "surrogate"))
        option = "--aero" if not by_name else "--surrogate"
        expected = f"{made}; no such file" if by_name else f"lattice, surrogate or {made}{hint}"
        yield Problem(COMMAND_LINE, option, file, expected)
    args.aero = file


def _assignments(texts: list[str], tables: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, str], list[Problem]]:
    """Values by path, the name that each path was given by, and the faults.

    A text that is no number stays a text: the definition's own check says what its key accepts.
    """
    overrides, names, problems = {}, {}, []
    inputs = _inputs(tables)
    for text in texts:
        name, equals, value = (part.strip() for part in text.partition("="))
        path = name if "." in name else inputs.get(name)
        if not name or not equals:
            expected = "NAME=VALUE, such as alpha=2.5 or wing.section.tip.twist_deg=-3"
            problems.append(Problem(COMMAND_LINE, "--set", text, expected))
        elif path is not None:
            overrides[path], names[path] = _number(value), f"--set {name}"
        elif tables:
            problems.append(Problem(COMMAND_LINE, f"--set {name}", value, _unknown(name, inputs)))
    return overrides, names, problems


def _inputs(tables: Mapping[str, Any]) -> dict[str, str]:
    """Bare names and their paths: flight condition, blade pitches, design variables (which come first)."""
    pitches = {f"theta_{g}": f"rotor.{g}.beta75_deg" for g in _texts(tables.get("rotor"), "name")}
    rows = tables.get("variables")
    variables = {}
    for row in rows if isinstance(rows, list) else []:
        if isinstance(row, dict) and isinstance(row.get("name"), str) and isinstance(row.get("path"), str):
            variables[row["name"]] = row["path"]
    return FLIGHT | pitches | variables


def _texts(rows: Any, key: str) -> list[str]:
    """A text of each table of an array, where it is one."""
    rows = rows if isinstance(rows, list) else []
    return [r[key] for r in rows if isinstance(r, dict) and isinstance(r.get(key), str)]


def _number(text: str) -> float | str:
    """A number, or the text as it is."""
    try:
        return float(text)
    except ValueError:
        return text


def _unknown(name: str, inputs: Mapping[str, str]) -> str:
    """What to say of a bare name that is none of the inputs."""
    if name in OUTPUTS:
        return f"an input; {name} is an output ({OUTPUTS[name].desc})"
    known = ", ".join(inputs)
    return f"an input ({known}) or the dotted path of a number{suggest(name, inputs)}"


def _relabel(problem: Problem, names: Mapping[str, str]) -> Problem:
    """Say by which ``--set`` a number was given."""
    if problem.file != OVERRIDE:
        return problem
    return Problem(names.get(problem.key, OVERRIDE), problem.key, problem.value, problem.expected)
