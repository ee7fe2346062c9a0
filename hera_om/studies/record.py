"""The record of a run: one SQLite file that holds OpenMDAO's cases and our own tables.

Beside OpenMDAO's tables stand ``hera_om (key, value)``, where a value is JSON, and ``hera_om_history
(iteration, value)``, one row an evaluation of the model by the driver. Every write is committed before the
call returns, so that a run killed at any moment loses no finished evaluation. `hera_om.post.read` reads it.

Keys: ``format kind definition definition_hash provenance options variables constraints objective started
process snapshot:baseline snapshot:optimum result failure finished``. A run that was killed has no
``finished``; one that raised has ``failure``. A number that is not finite is stored as null.
"""

import contextlib
import json
import math
import os
import socket
import sqlite3
import sys
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import numpy as np
import openmdao.api as om

from hera_om.aircraft import Aircraft, definition_hash, dumps, variable_box
from hera_om.core.errors import HeraError, RecordError
from hera_om.core.provenance import provenance
from hera_om.core.registry import quantity

FORMAT = 1
"""Version of the tables and keys; a reader refuses a larger one."""

KINDS = ("mdo", "trim", "analyze")

Row = dict[str, Any]


class Record:
    """The database of one run, open from construction to the end of the ``with`` block.

    Args:
        path: the file. An older database of ours is kept as ``PATH.bak``; any other file is refused.
        kind: one of `KINDS`.
        aircraft: the definition that runs.
        options: what the run was asked for: driver, aero, tolerances, start.
        variables: rows ``{name, path, units, lower, baseline, upper}``; absent: those of the definition.
        constraints: rows ``{name, units, lower, upper, reason}``; a bound is None where there is none.
        objective: ``{name, units, sense}`` with sense ``max`` or ``min``.

    Raises:
        RecordError: the file cannot be created, is somebody else's, or is being written by another process.
    """

    def __init__(
        self,
        path: str | Path,
        *,
        kind: str,
        aircraft: Aircraft,
        options: Mapping[str, Any] | None = None,
        variables: Sequence[Mapping[str, Any]] | None = None,
        constraints: Sequence[Mapping[str, Any]] = (),
        objective: Mapping[str, Any] | None = None,
    ) -> None:
        if kind not in KINDS:
            raise ValueError(f"kind {kind!r} is none of {', '.join(KINDS)}")
        self.path = Path(path).resolve()  # an absolute path, or OpenMDAO writes into its own output folder
        self.variables = [dict(v) for v in (_variables(aircraft) if variables is None else variables)]
        self.constraints = [dict(c) for c in constraints]
        self.objective = dict(objective) if objective else None
        self._begun = time.perf_counter()
        self._iteration = 0
        self._open()
        head = {
            "format": FORMAT,
            "kind": kind,
            "definition": dumps(aircraft),
            "definition_hash": definition_hash(aircraft),
            "provenance": provenance(),
            "options": dict(options or {}),
            "variables": self.variables,
            "constraints": self.constraints,
            "objective": self.objective,
            "started": _now(),
            "process": _process(os.getpid()),
        }
        self._write("INSERT OR REPLACE INTO hera_om VALUES (?, ?)", [(k, _json(v)) for k, v in head.items()])

    def __enter__(self) -> "Record":
        return self

    def __exit__(self, kind: Any, error: BaseException | None, trace: Any) -> None:
        """Note how the run ended and close; a full disk must not hide the error of the run itself."""
        if error is None:
            self.close()
            return
        with contextlib.suppress(RecordError):
            self.note("failure", _failure(error))
        with contextlib.suppress(RecordError):
            self.close()

    def attach(
        self,
        problem: om.Problem,
        *,
        outputs: Sequence[str] | None = None,
        progress: Callable[[Row], None] | None = None,
    ) -> None:
        """Record what a problem does: a driver case and a row of history for every evaluation.

        Call it after ``problem.setup()`` and before the run. ``problem.record("baseline")`` then adds a
        problem case.

        Args:
            problem: the problem, set up.
            outputs: promoted names of further outputs; absent: every single number with a registry name.
            progress: called with each row of history once it is safe on the disk.
        """
        names = list(outputs) if outputs is not None else _registry_scalars(problem)
        driver: Any = problem.driver
        for options in (driver.recording_options, problem.recording_options):
            options["includes"] = names
            options["record_desvars"] = options["record_objectives"] = options["record_constraints"] = True
        self._cases.on_driver = lambda success: self._evaluated(problem, names, success, progress)
        driver.add_recorder(self._cases)
        problem.add_recorder(self._cases)

    def note(self, key: str, value: Any) -> None:
        """Store a value, anything that JSON can hold, under a key; an older value is replaced."""
        self._write("INSERT OR REPLACE INTO hera_om VALUES (?, ?)", [(key, _json(value))])

    def history(self, row: Mapping[str, Any]) -> None:
        """Add one evaluation: ``iteration time_s objective worst_violation variables constraints outputs``.

        The last three are numbers by name. ``success: False`` marks an analysis that failed; its results
        are then absent.
        """
        iteration = int(row["iteration"])
        self._write("INSERT OR REPLACE INTO hera_om_history VALUES (?, ?)", [(iteration, _json(dict(row)))])
        self._iteration = max(self._iteration, iteration)

    def snapshot(self, name: str, content: Mapping[str, Any]) -> None:
        """Store ``{values, units, arrays}`` of a design, named ``baseline`` or ``optimum``."""
        self.note(f"snapshot:{name}", dict(content))

    def result(self, content: Mapping[str, Any]) -> None:
        """Store how the run ended and what it found."""
        self.note("result", dict(content))

    def close(self) -> None:
        """Mark the run as finished and close the file; a second call does nothing."""
        if self._connection is None:
            return
        try:
            self.note("finished", _now())
        finally:
            self._cases.shutdown()
            self._connection.close()
            self._connection = None

    def _open(self) -> None:
        """Create the file with OpenMDAO's tables and ours; on failure the older file is put back."""
        backup = self.path.with_name(self.path.name + ".bak")
        with _named(self.path):
            if not self.path.parent.is_dir():
                raise RecordError(f"{self.path}: there is no folder {self.path.parent}")
            older = _is_ours(self.path)
            if older:
                os.replace(self.path, backup)
            try:
                self._create()
            except BaseException:
                if older:
                    os.replace(backup, self.path)
                raise

    def _create(self) -> None:
        """Both sets of tables in a new file."""
        self._cases = _Cases(self.path)
        self._cases.create()
        self._connection: sqlite3.Connection | None = sqlite3.connect(self.path)
        with self._connection as c:
            c.execute("CREATE TABLE hera_om (key TEXT PRIMARY KEY, value TEXT)")
            c.execute("CREATE TABLE hera_om_history (iteration INTEGER PRIMARY KEY, value TEXT)")

    def _write(self, sql: str, rows: Sequence[tuple[Any, str]]) -> None:
        """Execute and commit."""
        if self._connection is None:
            raise RecordError(f"{self.path}: the record is closed")
        with _named(self.path), self._connection as c:
            c.executemany(sql, rows)

    def _evaluated(self, problem: om.Problem, names: Sequence[str], success: bool, progress) -> None:
        """Turn the state of a problem after a driver's evaluation into a row of history."""
        self._iteration += 1
        variables = {v["name"]: _scalar(problem, v["name"], v["units"]) for v in self.variables}
        row: Row = {
            "iteration": self._iteration,
            "time_s": time.perf_counter() - self._begun,
            "success": success,
            "objective": None,
            "worst_violation": None,
            "variables": variables,
            "constraints": {},
            "outputs": {},
        }
        if success:  # after a failure the model still holds the numbers of the evaluation before
            values = {c["name"]: _scalar(problem, c["name"], c["units"]) for c in self.constraints}
            row["constraints"] = values
            row["worst_violation"] = worst_violation(self.constraints, values)
            row["outputs"] = {n.rpartition(".")[2]: _scalar(problem, n, _units(n)) for n in names}
            if self.objective:
                row["objective"] = _scalar(problem, self.objective["name"], self.objective["units"])
        self.history(row)
        if progress is not None:
            progress(row)


class _Cases(om.SqliteRecorder):
    """OpenMDAO's recorder in the file of a `Record`: errors name the file, each driver case calls back."""

    def __init__(self, path: Path) -> None:
        super().__init__(str(path), record_viewer_data=False)
        self.on_driver: Callable[[bool], None] | None = None
        self._seen: BaseException | None = None

    def create(self) -> None:
        """Write the tables now: at start-up, where OpenMDAO does it, the file with ours would be removed."""
        self._initialize_database(None)

    def startup(self, recording_requester, comm=None) -> None:
        with _named(self._filepath):
            super().startup(recording_requester, comm)

    def record_iteration_driver(self, driver, data, metadata) -> None:
        if self.connection is None:
            return
        error = sys.exc_info()[1]
        failed = isinstance(error, om.AnalysisError) and error is not self._seen
        self._seen = error
        if failed:  # OpenMDAO records a failed case as a success with the outputs of the one before
            metadata = {**metadata, "success": 0, "msg": str(error)}
        with _named(self._filepath):
            super().record_iteration_driver(driver, data, metadata)
        if self.on_driver is not None:
            self.on_driver(bool(metadata["success"]))

    def record_iteration_problem(self, problem, data, metadata) -> None:
        with _named(self._filepath):
            super().record_iteration_problem(problem, data, metadata)

    def record_metadata_system(self, *args, **kwargs) -> None:
        with _named(self._filepath):
            super().record_metadata_system(*args, **kwargs)

    def record_metadata_solver(self, *args, **kwargs) -> None:
        with _named(self._filepath):
            super().record_metadata_solver(*args, **kwargs)

    def record_derivatives_driver(self, *args, **kwargs) -> None:
        with _named(self._filepath):
            super().record_derivatives_driver(*args, **kwargs)

    def shutdown(self) -> None:
        super().shutdown()
        self.connection = self.metadata_connection = None  # a later run of the problem is not recorded


def worst_violation(constraints: Sequence[Mapping[str, Any]], values: Mapping[str, float]) -> float:
    """The largest violation, each over the magnitude of the bound that is violated; zero: feasible.

    A bound of zero counts as one.
    """
    worst = 0.0
    for c in constraints:
        value, lower, upper = values[c["name"]], c["lower"], c["upper"]
        below = 0.0 if lower is None else (lower - value) / (abs(lower) or 1.0)
        above = 0.0 if upper is None else (value - upper) / (abs(upper) or 1.0)
        worst = max(worst, below, above)
    return worst


def _variables(aircraft: Aircraft) -> list[Row]:
    """The design variables of a definition as rows."""
    box = variable_box(aircraft)
    columns = (box.names, box.paths, box.units, box.lower, box.baseline, box.upper)
    keys = ("name", "path", "units", "lower", "baseline", "upper")
    return [dict(zip(keys, row, strict=True)) for row in zip(*columns, strict=True)]


def _registry_scalars(problem: om.Problem) -> list[str]:
    """Promoted names of the outputs that are single numbers with a registry name."""
    meta = problem.model.get_io_metadata(iotypes=("output",), metadata_keys=("shape",))
    own = {name: m for name, m in meta.items() if not name.startswith("_auto_ivc.")}  # the rest are inputs
    names = {m["prom_name"] for m in own.values() if m["shape"] is not None and math.prod(m["shape"]) == 1}
    return sorted(n for n in names if _known(n))


def _known(name: str) -> bool:
    """Whether the registry has the last part of a promoted name."""
    try:
        quantity(name.rpartition(".")[2])
    except KeyError:
        return False
    return True


def _units(name: str) -> str | None:
    """Registry unit of a promoted name; None where the model's own unit is to be kept."""
    return quantity(name.rpartition(".")[2]).units if _known(name) else None


def _scalar(problem: om.Problem, name: str, units: str | None) -> float:
    """A single number of a problem."""
    return float(np.ravel(problem.get_val(name, units=units))[0])


@contextlib.contextmanager
def _named(path: str | Path) -> Iterator[None]:
    """Turn an error of the file system or of SQLite into one that names the file."""
    try:
        yield
    except (OSError, sqlite3.Error) as error:
        raise RecordError(f"{path}: the record cannot be written: {error}") from error


def _is_ours(path: Path) -> bool:
    """Whether an older database of ours stands at a path; an error where it must not be replaced.

    Opening it also rolls back what a killed run left half written; its journal would otherwise spoil the
    new file, which has the same name.
    """
    if not path.exists() or (path.is_file() and path.stat().st_size == 0):
        return False
    refusal = f"{path}: the file is not a database of hera_om; it is not overwritten"
    try:
        with contextlib.closing(sqlite3.connect(f"{path.as_uri()}?mode=rw", uri=True)) as c:
            rows = dict(c.execute("SELECT key, value FROM hera_om WHERE key IN ('process', 'finished')"))
    except sqlite3.Error as error:
        raise RecordError(refusal) from error
    writer = json.loads(rows.get("process", "null"))
    if "finished" not in rows and writer and writer == _process(writer["pid"]):
        raise RecordError(f"{path}: process {writer['pid']} is writing this record")
    return True


def _process(pid: int) -> Row | None:
    """What identifies a live process, the moment of its start included; None when there is none."""
    try:
        os.kill(pid, 0)
        stat = Path(f"/proc/{pid}/stat")
        started = stat.read_text().rpartition(")")[2].split()[19] if stat.exists() else ""
    except PermissionError:
        started = ""
    except OSError:
        return None
    return {"host": socket.gethostname(), "pid": pid, "started": started}


def _failure(error: BaseException) -> Row:
    """An exception as the record keeps it."""
    to_json = getattr(error, "to_json", None)
    detail = to_json() if isinstance(error, HeraError) and to_json else {"kind": type(error).__name__}
    return {**detail, "message": str(error) or type(error).__name__}


def _now() -> str:
    """The moment, as ISO 8601 in UTC."""
    return datetime.now(UTC).isoformat(timespec="seconds")


def _json(value: Any) -> str:
    """JSON text of plain values, numpy's included."""
    return json.dumps(_plain(value), allow_nan=False)


def _plain(value: Any) -> Any:
    """The nearest JSON value; what is not finite becomes null."""
    if isinstance(value, Mapping):
        return {str(k): _plain(v) for k, v in value.items()}
    if isinstance(value, np.ndarray | np.generic) or hasattr(value, "__array__"):
        return _plain(np.asarray(value).tolist())
    if isinstance(value, list | tuple | set | frozenset):
        return [_plain(v) for v in value]
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return value if value is None or isinstance(value, str | int | bool) else str(value)
