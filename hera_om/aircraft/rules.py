"""What a cross-field rule reports."""

from typing import Any, NamedTuple


class Finding(NamedTuple):
    """One inconsistency: key, its value, what was expected, and the rule's short name."""

    key: str
    value: Any
    expected: str
    rule: str
