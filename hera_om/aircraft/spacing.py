"""Laws of spacing along a span or a chord: words for the common ones, AVL's blends by number."""

from itertools import pairwise
from typing import NamedTuple

from hera_om.core.spacing import law_at, law_number

LAW = r"^(uniform|cosine|sine|sine-inner|-?([0-2](\.[0-9]+)?|3(\.0+)?))$"
LAW_TEXT = (
    "'uniform', 'cosine', 'sine' (dense at the outer or rear end), 'sine-inner', "
    "or AVL's number from '-3' to '3' as text"
)


class Segment(NamedTuple):
    """Strips between two neighbouring sections: how many, and which part of which law they are spread by."""

    count: int
    law: float  # AVL's number, see `law_points`
    start: float  # part of the law's parameter, 0 to 1, that the segment takes, rescaled to its width
    end: float


def law_text(number: float) -> str:
    """The law's word, or its number as text.

    Raises:
        ValueError: outside -3..3.
    """
    if not -3.0 <= number <= 3.0:
        raise ValueError(f"{number:g} is no spacing law")
    number = round(number, 9)
    same = {0.0: "uniform", 1.0: "cosine", 2.0: "sine-inner", 3.0: "uniform"}
    if number == -2.0:
        return "sine"
    found = same.get(abs(number))
    return found if found else f"{number:.9f}".rstrip("0")


def segment_points(segment: Segment) -> tuple[float, ...]:
    """Edges (even places) and middles (odd places) of the strips as fractions of the segment, 2 count + 1 of them.

    A strip's condition stands at the middle of its interval of the law's parameter, as in AVL.
    """
    n, low = 2 * segment.count, law_at(segment.law, segment.start)
    width = law_at(segment.law, segment.end) - low
    at = [segment.start + (segment.end - segment.start) * i / n for i in range(1, n)]
    return (0.0, *((law_at(segment.law, u) - low) / width for u in at), 1.0)


def segments(counts: tuple[int, ...], own: tuple[str | None, ...], law: float) -> tuple[Segment, ...]:
    """Segments with given numbers of strips; those without an own law take their part of the surface's."""
    total, done, out = sum(counts), 0, []
    for count, text in zip(counts, own, strict=True):
        if text is not None:
            out.append(Segment(count, law_number(text), 0.0, 1.0))
        else:
            out.append(Segment(count, law, done / total, (done + count) / total))
        done += count
    return tuple(out)


def avl_counts(stations: tuple[float, ...], n: int, law: float) -> tuple[int, ...] | None:
    """Strips of each segment when AVL spreads n over a surface: each inner section takes the nearest strip edge.

    AVL then stretches the strips between sections to fit, which is what ``segments`` without own laws does.

    Returns:
        The counts, or None where two sections would take one edge (AVL stops there).
    """
    length = stations[-1] - stations[0]
    edges = [law_at(law, i / n) for i in range(n + 1)]
    inner = [min(range(n + 1), key=lambda i, s=s: abs(edges[i] - (s - stations[0]) / length)) for s in stations[1:-1]]
    places = [0, *inner, n]
    counts = tuple(b - a for a, b in pairwise(places))
    return counts if all(c > 0 for c in counts) else None
