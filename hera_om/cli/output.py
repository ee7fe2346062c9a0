"""Standard output for one JSON object or tables, standard error for progress and failures."""

import contextlib
import io
import json
import math
import os
import sys
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

from hera_om.core.errors import AnalysisFailure, InputError, RecordError

DONE, INTERNAL, BAD_INPUT, FAILED, INTERRUPTED = 0, 1, 2, 3, 130


class Failure(NamedTuple):
    """Why a command does not end with status 0."""

    status: int
    kind: str
    message: str
    problems: tuple[dict[str, Any], ...] = ()

    def to_json(self) -> dict[str, Any]:
        """The failure as the value of "error"."""
        return {"kind": self.kind, "message": self.message, "problems": list(self.problems)}


def failure_of(error: BaseException, command: str | None) -> Failure:
    """What an exception means to the user."""
    if isinstance(error, InputError):
        return Failure(BAD_INPUT, "input", str(error), tuple(p.to_json() for p in error.problems))
    if isinstance(error, RecordError):
        # a report only reads: there the damaged file is the input
        return Failure(BAD_INPUT if command == "report" else FAILED, "record", str(error))
    if isinstance(error, AnalysisFailure):
        problem = {"file": "", "key": error.where, "value": error.what, "expected": error.hint}
        return Failure(FAILED, "analysis", f"analysis failed: {error}", (problem,))
    if _is_openmdao_analysis_error(error):
        return Failure(FAILED, "analysis", f"analysis failed: {error}")
    text = " ".join(str(error).split()) or "no message"
    shown = f"internal error: {type(error).__name__}: {text} (run with --debug for the traceback)"
    return Failure(INTERNAL, "internal", shown)


def interruption(database: str | None) -> Failure:
    """What Ctrl-C leaves behind."""
    safe = f"; {database} is safe" if database and os.path.exists(database) else ""
    return Failure(INTERRUPTED, "interrupted", f"interrupted{safe}")


def progress(iteration: int, objective: float | None, worst_violation: float | None, seconds: float) -> None:
    """One line of progress on standard error; a reader who has left does not stop the run.

    Objective and violation are None where the analysis failed.
    """
    figures = "the analysis failed here"
    if objective is not None and worst_violation is not None:
        figures = f"objective {float(objective):< 15.8g} worst violation {float(worst_violation):9.2e}"
    say(f"{iteration:5d}  {figures:<51}  {float(seconds):7.1f} s")


def count(done: int, total: int, seconds: float) -> None:
    """One line of progress of a study that only counts its analyses."""
    say(f"{done:5d}  of {total:<48d}  {float(seconds):7.1f} s")


def say(text: str) -> None:
    """Print on standard error, if anybody still listens."""
    if sys.stderr is not None:  # print would take standard output instead
        with contextlib.suppress(OSError, ValueError):
            print(text, file=sys.stderr, flush=True)


def plain(value: Any) -> Any:
    """The nearest JSON value: an array becomes a list, NaN and infinity null, a complex number [re, im]."""
    if value is None or isinstance(value, bool | str):
        return str(value) if isinstance(value, str) else value
    if isinstance(value, int):
        return int(value)
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    if isinstance(value, complex):
        return [plain(value.real), plain(value.imag)]
    if isinstance(value, Mapping):
        return {str(key): plain(entry) for key, entry in value.items()}
    if hasattr(value, "_asdict"):
        return plain(value._asdict())
    if hasattr(value, "tolist"):
        return plain(value.tolist())
    if isinstance(value, list | tuple):
        return [plain(entry) for entry in value]
    return str(value)


def dump(result: Mapping[str, Any]) -> str:
    """One line of strict JSON."""
    return json.dumps(plain(result), allow_nan=False)


def emit(text: str, end: str = "\n") -> None:
    """Print on standard output; a reader who has left is no error.

    Raises:
        OSError: standard output cannot be written for another reason.
    """
    try:
        if isinstance(sys.stdout, io.TextIOWrapper):
            sys.stdout.reconfigure(errors="backslashreplace")  # a name that the terminal cannot show
        print(text, end=end, flush=True)
    except OSError as error:
        _drop_stdout()
        if not isinstance(error, BrokenPipeError):
            raise


@contextlib.contextmanager
def stdout_to_stderr() -> Iterator[None]:
    """Send what libraries print, compiled ones included, to standard error while a command runs."""
    with contextlib.redirect_stdout(sys.stderr):
        try:
            saved = os.dup(1)
        except OSError:  # there is no standard output
            yield
            return
        try:
            with contextlib.suppress(OSError):
                os.dup2(2, 1)
            yield
        finally:
            _flush_compiled()
            os.dup2(saved, 1)
            os.close(saved)


def _flush_compiled() -> None:
    """Empty the buffers of the C library, or they would end up behind the JSON."""
    import ctypes

    with contextlib.suppress(OSError, AttributeError, TypeError):
        ctypes.CDLL(None).fflush(None)


def _drop_stdout() -> None:
    """Let the interpreter flush into nothing when it ends."""
    with contextlib.suppress(OSError, ValueError):
        nothing = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nothing, sys.stdout.fileno())
        os.close(nothing)


def _is_openmdao_analysis_error(error: BaseException) -> bool:
    """Whether this is OpenMDAO's AnalysisError, without importing OpenMDAO."""
    classes = type(error).__mro__
    return any(c.__name__ == "AnalysisError" and c.__module__.startswith("openmdao") for c in classes)
