"""One function for each command: arguments in, result, table and failure out. Heavy imports stand inside."""

import argparse
import os
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

from hera_om.cli.output import FAILED, Failure, count, plain, progress
from hera_om.cli.parser import COMMAND_LINE
from hera_om.core.errors import InputError, Problem


class Outcome(NamedTuple):
    """What a command found, how to show it to a person, and why it is not good enough, if so."""

    result: Mapping[str, Any]
    show: Callable[[Mapping[str, Any]], str]
    failure: Failure | None = None


def check(args: argparse.Namespace) -> Outcome:
    """Validate a definition."""
    from hera_om.aircraft import definition_hash, numbers
    from hera_om.cli.inputs import prepare
    from hera_om.cli.tables import check_text

    aircraft = prepare(args)
    fields = {k: f for k, f in type(aircraft).model_fields.items() if k not in ("name", "source", "variables")}
    parts = [k for k, field in fields.items() if getattr(aircraft, k) != field.default]
    result = {
        "valid": True,
        "aircraft": aircraft.name,
        "hash": definition_hash(aircraft),
        "parts": parts,
        "numbers": len(numbers(aircraft)),
        "variables": [v.name for v in aircraft.variables],
        "rotors": [r.name for r in aircraft.rotor],
    }
    return Outcome(result, check_text)


def analyze(args: argparse.Namespace) -> Outcome:
    """One flight condition."""
    from hera_om.cli.inputs import prepare
    from hera_om.cli.tables import analyze_text

    aircraft = prepare(args)
    from hera_om.components.aero_stages import begin

    begin(aircraft)  # compiled code loads while OpenMDAO is imported
    from hera_om.studies import analyze

    return Outcome(plain(analyze(aircraft)), analyze_text)


def trim(args: argparse.Namespace) -> Outcome:
    """Steady flight."""
    from hera_om.cli.inputs import prepare
    from hera_om.cli.tables import trim_text

    aircraft = prepare(args)
    from hera_om.studies import trim

    result = trim(
        aircraft,
        method=args.method,
        aero=args.aero,
        load_factor=args.load_factor,
        database=args.db,
        progress=progress,
    )
    result = plain(result)
    return Outcome(result, trim_text, None if result["trimmed"] else _not_trimmed(result))


def mdo(args: argparse.Namespace) -> Outcome:
    """Optimise."""
    from hera_om.cli.inputs import prepare
    from hera_om.cli.tables import mdo_text

    aircraft = prepare(args)
    from hera_om.studies import mdo

    result = mdo(
        aircraft,
        driver=args.driver,
        aero=args.aero,
        database=args.db,
        start=args.start,
        max_iterations=args.max_iterations,
        progress=progress,
    )
    result = plain(result)
    failure = None if result["feasible"] else _infeasible(result)
    return Outcome(result, lambda r: f"{mdo_text(r)}\n\nrecord: {args.db}", failure)


def train(args: argparse.Namespace) -> Outcome:
    """Surrogates of the aerodynamics."""
    from hera_om.cli.inputs import prepare
    from hera_om.cli.tables import train_text

    aircraft = prepare(args)
    from hera_om.studies import train

    result = train(aircraft, samples=args.samples, seed=args.seed, out=args.out, progress=count)
    return Outcome(plain(result), train_text)


def interaction(args: argparse.Namespace) -> Outcome:
    """Rotors, wing and tail, together and taken apart."""
    from hera_om.cli.inputs import prepare
    from hera_om.cli.tables import interaction_text

    aircraft = prepare(args)
    folder = _folder(args.folder)
    from hera_om.studies import interact

    result = plain(interact(aircraft))
    if folder is not None:
        from hera_om.post.figures_interaction import write_figures

        result |= {"figures": [str(path) for path in write_figures(result, folder)]}
    return Outcome(result, interaction_text)


def _folder(name: str | None) -> Path | None:
    """A folder for figures, made if it is not there; bad input if it cannot be."""
    if name is None:
        return None
    folder = Path(name)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or str(error)
        expected = f"a folder that exists or can be made ({reason.lower()})"
        raise InputError([Problem(COMMAND_LINE, "--out", name, expected)]) from None
    if not os.access(folder, os.W_OK):
        raise InputError([Problem(COMMAND_LINE, "--out", name, "a folder that can be written")])
    return folder


def report(args: argparse.Namespace) -> Outcome:
    """The page of a run."""
    from hera_om.cli.inputs import page_file, record_file

    database = record_file(args.database)
    page = page_file(args.out, database)
    from hera_om.post import write_report

    write_report(database, page)
    result = {"database": str(database), "report": str(page)}
    return Outcome(result, lambda r: f"wrote {r['report']}")


COMMANDS = {f.__name__: f for f in (check, analyze, trim, mdo, train, interaction, report)}


def _not_trimmed(result: Mapping[str, Any]) -> Failure:
    """Name the controls at their bounds."""
    from hera_om.cli.tables import saturated_names

    names = saturated_names(result)
    cause = f": {', '.join(names)} at its bound" if names else ""
    problems = [{"file": "", "key": n, "value": None, "expected": "a value inside its bounds"} for n in names]
    return Failure(FAILED, "infeasible", f"the aircraft is not trimmed{cause}", tuple(problems))


def _infeasible(result: Mapping[str, Any]) -> Failure:
    """Name the constraints that are violated."""
    from hera_om.cli.tables import violated_constraints

    problems = tuple(
        {"file": "", "key": name, "value": row.get("value"), "expected": text}
        for name, row, text in violated_constraints(result)
    )
    names = ", ".join(p["key"] for p in problems)
    return Failure(FAILED, "infeasible", f"the result is infeasible{f': {names}' if names else ''}", problems)
