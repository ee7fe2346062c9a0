"""Tables of section polars: from a CSV file, from NeuralFoil, or written out; read when a definition loads.

What is loaded stays in the definition as CSV text, as a shipped material is copied in: the hash covers it, a
definition written out needs no second file, and its numbers are structure that no compiled function traces.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import Field, ValidationError

from hera_om.aircraft.fields import Constant, Part, item, number
from hera_om.core.errors import InputError, Problem

COLUMNS = ("alpha_deg", "reynolds", "mach", "cl", "cd", "cm")
OPTIONAL = "cm"  # zero where the table has none
INSTALL = "pip install 'hera-om[neuralfoil]'"
MODELS = Literal["xxsmall", "xsmall", "small", "medium", "large", "xlarge", "xxlarge", "xxxlarge"]


class NeuralFoil(Part):
    """A polar table from NeuralFoil (Sharpe and Hansman, 2025), made once when the definition loads."""

    airfoil: str = item("section as aerosandbox names it, such as 'naca2412'", pattern=r"^[A-Za-z0-9 ._-]+$")
    alpha_min_deg: float = number("lowest incidence", "deg", -16.0, ge=-30, le=0)
    alpha_max_deg: float = number("highest incidence", "deg", 20.0, ge=0, le=30)
    alpha_step_deg: float = number("distance between incidences", "deg", 1.0, ge=0.25, le=4)
    reynolds: tuple[float, ...] = Field((1e6, 3e6, 1e7, 3e7), description="Reynolds numbers [-]", min_length=1)
    n_crit: float = number("amplification exponent of transition", "", 9.0, ge=1, le=20)
    model: MODELS = item("size of the network", "xlarge")


class PolarTable(Part):
    """Section coefficients over incidence, Reynolds and Mach number; one of file, neuralfoil and csv."""

    file: str | None = item("CSV file beside the definition, copied into csv when loading", None)
    neuralfoil: NeuralFoil | None = item("NeuralFoil's answer, copied into csv when loading", None)
    csv: str | None = item("the table: alpha_deg,reynolds,mach,cl,cd[,cm], one line a point; cm is not applied", None)
    source: str = item("where the table comes from", "")


class BladePolarTable(PolarTable):
    """Section coefficients of a blade, up to 180 degrees either way or extended to there: beyond its ends a table
    follows the law of stalled blades of Viterna and Corrigan.
    """

    extend: bool = item("whether to extend a table that ends short of 180 degrees", True)
    compressible: bool = item("Prandtl-Glauert up to Mach 0.7 on a table of Mach 0 alone that is extended", True)
    aspect_ratio: Annotated[float | None, Constant] = number(
        "tip radius over the chord at 75 % of it, for the drag of the extension; filled in when loading", "", None, gt=0
    )


def load_polar_tables(data: dict[str, Any], folder: Path | None, file: str) -> list[Problem]:
    """Put the text of every polar table into the raw definition, in place, and check it.

    Args:
        data: raw tables of a definition; ``polar_table`` is looked for at every depth.
        folder: where relative files stand; None (a definition that is no file): the working folder.
        file: what a report calls the definition.

    Returns:
        Every fault; a table with one is taken out or emptied, so that later checks do not repeat it.
    """
    problems: list[Problem] = []
    for path, holder in _holders(data, ""):
        blade = holder if path.startswith(("blade.", "blade[")) else None
        try:
            holder["polar_table"] = _loaded(holder["polar_table"], folder or Path(), file, path, blade)
        except InputError as error:
            problems += error.problems
            if blade is None:
                del holder["polar_table"]
            else:  # which has a polar of some kind
                holder["polar_table"] = {}
    return problems


def _holders(node: Any, path: str) -> Iterator[tuple[str, dict[str, Any]]]:
    """Every raw table that has a polar table, with the path of the latter."""
    if isinstance(node, dict):
        if "polar_table" in node:
            yield f"{path}.polar_table".lstrip("."), node
        for key, child in node.items():
            if key != "polar_table":
                yield from _holders(child, f"{path}.{key}")
    elif isinstance(node, list | tuple):
        for i, child in enumerate(node):
            name = child.get("name") if isinstance(child, dict) else None
            yield from _holders(child, f"{path}.{name}" if isinstance(name, str) else f"{path}[{i}]")


def _loaded(raw: Any, folder: Path, file: str, path: str, blade: dict[str, Any] | None) -> Any:
    """The raw polar table with its text in ``csv``; what pydantic will refuse passes through."""
    if not isinstance(raw, dict):
        return raw
    given = [key for key in ("file", "neuralfoil", "csv") if key in raw]
    if len(given) != 1:
        expected = "one of file, neuralfoil and csv"
        raise InputError([Problem(file, path, ", ".join(given) or None, expected)])
    rest = {k: v for k, v in raw.items() if k not in given}
    if given == ["file"] and isinstance(raw["file"], str):
        text, source = _read(folder / raw["file"], raw["file"], file, path), f"file {raw['file']}"
    elif given == ["neuralfoil"]:
        text, source = _from_neuralfoil(raw["neuralfoil"], file, path), "NeuralFoil"
    elif given == ["csv"] and isinstance(raw["csv"], str):
        text, source = raw["csv"], ""
    else:
        return raw
    # numpy, which a definition without tables need not import
    from hera_om.aircraft.polar_data import aspect_ratio, extends, polar_arrays

    label = raw["file"] if given == ["file"] else f"{file}: {path}.{given[0]}"
    if blade is None:
        polar_arrays(text, label)
    elif extends(text, label, raw, key=(file, path)) and "aspect_ratio" not in raw:
        ratio = aspect_ratio(blade.get("r"), blade.get("c"))
        rest = rest if ratio is None else {**rest, "aspect_ratio": ratio}
    return {**({"source": source} if source else {}), **rest, "csv": text}


def _read(path: Path, name: str, file: str, key: str) -> str:
    """Text of a CSV file, or the one problem that keeps it from being read."""
    try:
        return path.read_text("utf-8-sig")
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or "not UTF-8 text"
        raise InputError([Problem(file, f"{key}.file", name, f"a CSV file that can be read ({reason})")]) from None


def _from_neuralfoil(raw: Any, file: str, key: str) -> str:
    """NeuralFoil's table, its faults as problems."""
    from hera_om.aircraft.polar_data import neuralfoil_table

    path = f"{key}.neuralfoil"
    try:
        wanted = NeuralFoil.model_validate(_as_tuples(raw))
        return neuralfoil_table(wanted)
    except ValidationError as error:
        found = [(".".join([path, *map(str, e["loc"])]), e["input"], e["msg"]) for e in error.errors()]
        raise InputError(Problem(file, where, str(value), text) for where, value, text in found) from None
    except ModuleNotFoundError as error:
        raise InputError([Problem(file, path, f"no module {error.name}", f"the optional extra: {INSTALL}")]) from None
    except ValueError as error:
        raise InputError([Problem(file, f"{path}.airfoil", str(error), "an airfoil that aerosandbox knows")]) from None


def _as_tuples(raw: Any) -> Any:
    """Lists of a raw table to tuples, numbers of an array to floats."""
    if not isinstance(raw, dict):
        return raw
    return {k: tuple(v) if isinstance(v, list) else v for k, v in raw.items()}
