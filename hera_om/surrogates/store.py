"""Sets of surrogates on disk: one .npz of plain arrays with a JSON header inside, never a pickle."""

import json
import os
import tempfile
import zipfile
import zlib
from pathlib import Path
from typing import Any, get_args

import numpy as np

from hera_om.core.errors import RecordError
from hera_om.surrogates.kriging import KrigingModel
from hera_om.surrogates.quality import Quality
from hera_om.surrogates.rbf import RbfModel
from hera_om.surrogates.samples import Samples
from hera_om.surrogates.surrogate_set import Kind, Predictor, SurrogateSet

FORMAT = "hera_om surrogates"
FORMAT_VERSION = 1
FILE_NAME = "surrogates.npz"
"""Name of the file where only a folder is given."""

_PARTS = {"predictor": Predictor, "kriging": KrigingModel, "rbf": RbfModel, "samples": Samples}


def save(surrogates: SurrogateSet, path: str | os.PathLike[str]) -> Path:
    """Write a set to a file ending in .npz, or to ``surrogates.npz`` in a folder (made where it is missing).

    The file appears whole or not at all: it is written beside its place and then renamed, so that a run
    killed at any moment leaves the old file, or none.

    Args:
        surrogates: a trained set.
        path: file or folder.

    Returns:
        The file.

    Raises:
        OSError: the place cannot be written.
    """
    file = _file(path)
    file.parent.mkdir(parents=True, exist_ok=True)
    header = np.frombuffer(json.dumps(_header(surrogates), allow_nan=False).encode(), dtype=np.uint8)
    handle, temporary = tempfile.mkstemp(dir=file.parent, prefix=f".{file.name}.", suffix=".part")
    try:
        with os.fdopen(handle, "wb") as stream:
            np.savez(stream, allow_pickle=False, header=header, **_arrays(surrogates))
            stream.flush()
            os.fsync(stream.fileno())
        os.replace(temporary, file)
    except BaseException:
        os.unlink(temporary)
        raise
    return file


def load(path: str | os.PathLike[str]) -> SurrogateSet:
    """Read a set that ``save`` wrote.

    Args:
        path: file or folder, as for ``save``.

    Returns:
        The set; it predicts as the saved one does, to the last bit.

    Raises:
        RecordError: the file is missing, damaged, cut short, of another kind or version, or does not agree
            with itself; the message names the file and the reason.
    """
    file = _file(path)
    try:
        with np.load(file, allow_pickle=False) as archive:
            content = {key: archive[key] for key in archive.files}
    except (OSError, ValueError, EOFError, zipfile.BadZipFile, zlib.error, NotImplementedError) as error:
        raise RecordError(f"{file}: cannot be read as a file of surrogates: {error}") from error
    except TypeError as error:
        # NumPy gives a bare array, which is no context, for a file of another of its kinds.
        raise RecordError(f"{file}: is not an archive of arrays") from error
    try:
        return _rebuild(content)
    except (KeyError, TypeError, ValueError, UnicodeDecodeError) as error:
        reason = f"{error.args[0]} is missing" if isinstance(error, KeyError) else str(error)
        raise RecordError(f"{file}: {reason}") from error


def _file(path: str | os.PathLike[str]) -> Path:
    """The file that a path means."""
    chosen = Path(path)
    return chosen if chosen.suffix == ".npz" else chosen / FILE_NAME


def _header(surrogates: SurrogateSet) -> dict[str, Any]:
    """Everything that is not an array, as JSON takes it."""
    keys = ("input_names", "input_units", "output_names", "output_units", "output_sizes", "kinds")
    return {
        "format": FORMAT,
        "version": FORMAT_VERSION,
        **{key: list(getattr(surrogates, key)) for key in keys},
        "lower": surrogates.lower.tolist(),
        "upper": surrogates.upper.tolist(),
        "quality": [{kind: q._asdict() for kind, q in models.items()} for models in surrogates.quality],
        "seed": surrogates.seed,
        "definition_hash": surrogates.definition_hash,
        "versions": dict(surrogates.versions),
    }


def _arrays(surrogates: SurrogateSet) -> dict[str, np.ndarray]:
    """Every array by part and name; the parts inside the predictor stand beside it."""
    predictor = surrogates.predictor
    parts = {
        "predictor": predictor,
        "kriging": predictor.kriging,
        "rbf": predictor.rbf,
        "samples": surrogates.samples,
    }
    return {
        f"{part}.{name}": value
        for part, values in parts.items()
        for name, value in values._asdict().items()
        if isinstance(value, np.ndarray)
    }


def _rebuild(content: dict[str, np.ndarray]) -> SurrogateSet:
    """The set from what the file holds, refused with a ValueError where that does not fit together."""
    header = json.loads(content["header"].tobytes())
    if not isinstance(header, dict) or header.get("format") != FORMAT:
        raise ValueError("is not a file of surrogates")
    if header.get("version") != FORMAT_VERSION:
        raise ValueError(f"has format version {header.get('version')}; this program reads {FORMAT_VERSION}")
    _check_shapes(header, content)
    parts: dict[str, Any] = {}
    for part in ("kriging", "rbf", "samples", "predictor"):
        names = _PARTS[part]._fields
        parts[part] = _PARTS[part](**{n: parts[n] if n in parts else content[f"{part}.{n}"] for n in names})
    return SurrogateSet(
        input_names=tuple(header["input_names"]),
        input_units=tuple(header["input_units"]),
        output_names=tuple(header["output_names"]),
        output_units=tuple(header["output_units"]),
        output_sizes=tuple(header["output_sizes"]),
        kinds=tuple(header["kinds"]),
        quality=tuple({kind: Quality(**q) for kind, q in models.items()} for models in header["quality"]),
        predictor=parts["predictor"],
        samples=parts["samples"],
        seed=header["seed"],
        definition_hash=header["definition_hash"],
        versions=header["versions"],
    )


def _check_shapes(header: dict[str, Any], content: dict[str, np.ndarray]) -> None:
    """Shapes, types and values of all arrays against the names in the header and against each other."""
    d, outputs, m = len(header["input_names"]), len(header["output_names"]), sum(header["output_sizes"])
    for key, count in {
        "input_units": d,
        "output_units": outputs,
        "output_sizes": outputs,
        "kinds": outputs,
    }.items():
        if len(header[key]) != count:
            raise ValueError(f"{key} has {len(header[key])} entries, not {count}")
    if not set(header["kinds"]) <= set(get_args(Kind)):
        raise ValueError(f"kinds are {header['kinds']}, not all among {get_args(Kind)}")
    if [kind in models for kind, models in zip(header["kinds"], header["quality"], strict=True)] != [True] * outputs:
        raise ValueError("quality of a chosen model is missing")
    n, tests = len(content["samples.x"]), len(content["samples.x_test"])
    k, r = len(content["kriging.mean"]), len(content["rbf.constant"])
    expected = {
        "predictor.lower": (d,),
        "predictor.upper": (d,),
        "predictor.offset": (m,),
        "predictor.lift": (m, k + r),
        "kriging.points": (n, d),
        "kriging.theta": (k, d),
        "kriging.weights": (n, k),
        "kriging.mean": (k,),
        "rbf.points": (n, d),
        "rbf.width": (r,),
        "rbf.weights": (n, r),
        "rbf.constant": (r,),
        "rbf.slope": (d, r),
        "samples.x": (n, d),
        "samples.y": (n, m),
        "samples.x_test": (tests, d),
        "samples.y_test": (tests, m),
    }
    for key, shape in expected.items():
        array = content[key]
        if array.shape != shape or array.dtype != np.float64:
            raise ValueError(f"{key} is {array.dtype} of shape {array.shape}, not float64 of {shape}")
        if not np.all(np.isfinite(array)):
            raise ValueError(f"{key} holds a number that is not finite")
    for key in ("lower", "upper"):
        if not np.array_equal(content[f"predictor.{key}"], header[key]):
            raise ValueError(f"{key} differs between header and arrays")
