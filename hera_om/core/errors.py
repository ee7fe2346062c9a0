"""The exceptions of hera_om: bad input, a failed analysis, a damaged record."""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any


class HeraError(Exception):
    """Base of every error that hera_om raises on purpose."""


@dataclass(frozen=True)
class Problem:
    """One fault of an input: where it stands, what stands there, and what was expected instead.

    Attributes:
        file: file name, or a label such as ``override`` for a value that came from elsewhere.
        key: dotted path of the key; empty when the fault concerns the file as a whole.
        value: the offending value, None when it is absent; for a file as a whole, what is wrong with it.
        expected: what would have been accepted, in words.
    """

    file: str
    key: str
    value: Any
    expected: str

    def __str__(self) -> str:
        if not self.key:
            return f"{self.file}: {self.value}; expected {self.expected}"
        return f"{self.file}: {self.key}: got {_show(self.value)}, expected {self.expected}"

    def to_json(self) -> dict[str, Any]:
        """The fault as plain JSON values; NaN and infinity, which JSON lacks, become text."""
        return {"file": self.file, "key": self.key, "value": _plain(self.value), "expected": self.expected}


class InputError(HeraError):
    """Bad input: every fault found, in one report."""

    def __init__(self, problems: Iterable[Problem]) -> None:
        self.problems = tuple(problems)
        super().__init__(self.problems)

    def __str__(self) -> str:
        count = len(self.problems)
        return "\n".join([f"{count} error{'s' if count != 1 else ''} in the input", *map(str, self.problems)])

    def to_json(self) -> dict[str, Any]:
        """The report as a dictionary of plain JSON values."""
        return {"kind": "input", "message": str(self), "problems": [p.to_json() for p in self.problems]}


class AnalysisFailure(HeraError):
    """The input was sound but the physics, the trim or a solver failed.

    Attributes:
        what: what failed, in words.
        where: the component, rotor, control or condition concerned.
        hint: what the user may try; may be empty.
    """

    def __init__(self, what: str, where: str = "", hint: str = "") -> None:
        self.what, self.where, self.hint = what, where, hint
        super().__init__(what, where, hint)

    def __str__(self) -> str:
        text = f"{self.where}: {self.what}" if self.where else self.what
        return f"{text} ({self.hint})" if self.hint else text

    def to_json(self) -> dict[str, Any]:
        """The failure as a dictionary of plain JSON values."""
        return {"kind": "analysis", "what": self.what, "where": self.where, "hint": self.hint}


class RecordError(HeraError):
    """A file that we wrote (database, surrogate, snapshot) is damaged or is not what it claims to be."""

    def to_json(self) -> dict[str, Any]:
        """The failure as a dictionary of plain JSON values."""
        return {"kind": "record", "message": str(self)}


def _show(value: Any) -> str:
    """A value for a line of the report: short, on one line."""
    if value is None:
        return "nothing"
    text = repr(value)
    return text if len(text) <= 80 else text[:77] + "..."


def _plain(value: Any) -> Any:
    """The nearest JSON value."""
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    return value if value is None or isinstance(value, str | int | float | bool) else str(value)
