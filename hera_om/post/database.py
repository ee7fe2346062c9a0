"""Read the database of a run: our own tables as one typed, frozen object."""

import contextlib
import json
import math
import sqlite3
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from hera_om.aircraft import Aircraft, loads
from hera_om.core.errors import InputError, RecordError

FORMAT = 1
"""The newest version of the tables that this reader knows; the writer's: `hera_om.studies.record`."""


@dataclass(frozen=True)
class Variable:
    """A design variable of the run."""

    name: str
    path: str
    units: str | None
    lower: float
    baseline: float
    upper: float


@dataclass(frozen=True)
class Constraint:
    """A constraint of the run; a bound is None where there is none."""

    name: str
    units: str | None
    lower: float | None
    upper: float | None
    reason: str = ""

    def margin(self, value: float) -> float:
        """Distance to the bound that is relatively nearer, in the constraint's unit; negative: violated."""
        return min(self._gaps(value), default=(math.inf, math.inf))[1]

    def relative(self, value: float) -> float:
        """The same distance over the magnitude of the bound; a bound of zero counts as one."""
        return min(self._gaps(value), default=(math.inf, math.inf))[0]

    def _gaps(self, value: float) -> list[tuple[float, float]]:
        """Relative and absolute distance to each bound."""
        gaps = [(value - self.lower, self.lower)] if self.lower is not None else []
        gaps += [(self.upper - value, self.upper)] if self.upper is not None else []
        return [(gap / (abs(bound) or 1.0), gap) for gap, bound in gaps]


@dataclass(frozen=True)
class Objective:
    """What the run optimised; ``sense`` is ``max`` or ``min``."""

    name: str
    units: str | None
    sense: str


@dataclass(frozen=True)
class Snapshot:
    """One design in full: numbers by registry name with their units, and arrays for pictures."""

    values: dict[str, float]
    units: dict[str, str | None] = field(default_factory=dict)
    arrays: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Run:
    """A run as its database tells it.

    Attributes:
        path: the database.
        kind: ``mdo``, ``trim`` or ``analyze``.
        definition: the aircraft as TOML; `aircraft` is the same, loaded.
        history: one row an evaluation, in order.
        baseline, optimum: snapshots; None where the run did not get so far.
        result: how it ended and what it found; None where it did not get so far.
        failure: the error that stopped it, or None.
        started, finished: ISO 8601 in UTC; ``finished`` is None after a kill, or while it still runs.
    """

    path: Path
    kind: str
    definition: str
    definition_hash: str
    provenance: dict[str, Any]
    options: dict[str, Any]
    variables: tuple[Variable, ...]
    constraints: tuple[Constraint, ...]
    objective: Objective | None
    history: tuple[dict[str, Any], ...]
    baseline: Snapshot | None = None
    optimum: Snapshot | None = None
    result: dict[str, Any] | None = None
    failure: dict[str, Any] | None = None
    started: str | None = None
    finished: str | None = None

    @property
    def status(self) -> str:
        """``finished``, ``failed``, or ``unfinished``: killed, or still running."""
        if self.failure is not None:
            return "failed"
        return "finished" if self.result is not None else "unfinished"

    @cached_property
    def aircraft(self) -> Aircraft:
        """The definition that ran.

        Raises:
            RecordError: this version of hera_om does not accept it.
        """
        try:
            return loads(self.definition, file=f"{self.path} (definition)")
        except InputError as error:
            raise RecordError(f"{self.path}: the recorded definition does not load: {error}") from error


def read(path: str | Path) -> Run:
    """The run that a database holds, finished or not.

    Raises:
        RecordError: the file is missing, damaged, no database of hera_om, or of a newer format; the message
            names the file and the reason.
    """
    path = Path(path).resolve()
    if not path.is_file():
        raise RecordError(f"{path}: {'a folder, no database' if path.is_dir() else 'no such file'}")
    try:
        keys, rows = _tables(path)
    except sqlite3.Error as error:
        raise RecordError(f"{path}: damaged, or no SQLite database: {error}") from error
    return _run(path, {k: _decode(path, k, v) for k, v in keys.items()}, rows)


def as_run(source: "str | Path | Run") -> Run:
    """A run as it is, or the one that a database holds."""
    return source if isinstance(source, Run) else read(source)


def cases(source: "str | Path | Run") -> Any:
    """OpenMDAO's own reader on the same file, for its driver and problem cases.

    Raises:
        RecordError: no model was run under this record, so that it has no cases.
    """
    import openmdao.api as om

    path = as_run(source).path
    try:
        return om.CaseReader(str(path))
    except TypeError as error:  # OpenMDAO's metadata are null until a model starts
        raise RecordError(f"{path}: the record has no cases of OpenMDAO") from error


def _tables(path: Path) -> tuple[dict[str, str], list[tuple[int, str]]]:
    """Both tables; opened for writing where possible, since a killed run may need a rollback."""
    with contextlib.closing(sqlite3.connect(f"{path.as_uri()}?mode=rw", uri=True)) as c:
        names = {name for (name,) in c.execute("SELECT name FROM sqlite_master WHERE type = 'table'")}
        if not {"hera_om", "hera_om_history"} <= names:
            raise RecordError(f"{path}: an SQLite database, but not one of hera_om")
        (verdict,) = c.execute("PRAGMA quick_check(1)").fetchone()
        if verdict != "ok":
            raise RecordError(f"{path}: damaged: {' '.join(verdict.split())}")
        keys = dict(c.execute("SELECT key, value FROM hera_om"))
        return keys, list(c.execute("SELECT iteration, value FROM hera_om_history ORDER BY iteration"))


def _decode(path: Path, key: str, text: str) -> Any:
    """JSON of one value."""
    try:
        return json.loads(text)
    except (ValueError, TypeError) as error:
        raise RecordError(f"{path}: damaged: {key} is not JSON: {error}") from error


def _run(path: Path, keys: Mapping[str, Any], rows: list[tuple[int, str]]) -> Run:
    """The typed run; every missing key or wrong type is damage."""
    version = keys.get("format")
    if not isinstance(version, int):
        raise RecordError(f"{path}: damaged or never begun: it does not say its format")
    if version > FORMAT:
        raise RecordError(f"{path}: format {version} is newer than {FORMAT}, the newest that this hera_om reads")
    try:
        return Run(
            path=path,
            kind=keys["kind"],
            definition=keys["definition"],
            definition_hash=keys["definition_hash"],
            provenance=dict(keys["provenance"]),
            options=dict(keys["options"]),
            variables=tuple(Variable(**v) for v in keys["variables"]),
            constraints=tuple(Constraint(**c) for c in keys["constraints"]),
            objective=_optional(keys, "objective", lambda o: Objective(**o)),
            history=tuple(_decode(path, f"history row {i}", text) for i, text in rows),
            baseline=_optional(keys, "snapshot:baseline", _snapshot),
            optimum=_optional(keys, "snapshot:optimum", _snapshot),
            result=keys.get("result"),
            failure=keys.get("failure"),
            started=keys.get("started"),
            finished=keys.get("finished"),
        )
    except KeyError as error:
        raise RecordError(f"{path}: damaged: the key {error} is missing") from error
    except (TypeError, ValueError, AttributeError) as error:
        raise RecordError(f"{path}: damaged: {error}") from error


def _optional(keys: Mapping[str, Any], key: str, build: Callable[[Any], Any]) -> Any:
    """A part that may be absent."""
    content = keys.get(key)
    return None if content is None else build(content)


def _snapshot(content: Mapping[str, Any]) -> Snapshot:
    """A snapshot; null is a number that was not finite."""
    values = {k: float("nan") if v is None else float(v) for k, v in content["values"].items()}
    return Snapshot(values, dict(content.get("units", {})), dict(content.get("arrays", {})))
