"""Stages kept on disk as portable programs, so that the next process need not trace them.

JAX's own cache keeps compiled code but has the Python functions traced first, which takes most of a short command.
A kept program is found again by the source of the package, the versions, the static arguments and the shapes. Only a
process that says so (`keep`) uses them: one that changes functions or constants at run time must not.
"""

import hashlib
import os
import pickle
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any

from hera_om.core.precision import cache_dir

_kept = False


def keep() -> None:
    """Let this process keep and find programs."""
    global _kept
    _kept = True


def program(function: Callable[..., Any], statics: int, options: dict[str, Any] | None = None) -> Callable[..., Any]:
    """A jitted function whose program is kept on disk, if this process keeps any.

    Args:
        function: pure function of pytrees.
        statics: how many leading arguments are static; their ``repr`` must say all that matters.
        options: of XLA, for this function alone.

    Returns:
        The function, compiled when it is called.
    """
    import jax
    import numpy as np

    jitted = jax.jit(function, static_argnums=tuple(range(statics)), compiler_options=options)
    found: dict[Any, Callable[..., Any]] = {}

    def call(*args: Any) -> Any:
        if not _kept:
            return jitted(*args)
        leaves, tree = jax.tree.flatten(args[statics:])
        leaves = [leaf if isinstance(leaf, jax.Array) else np.asarray(leaf) for leaf in leaves]
        shapes = tuple((leaf.shape, str(leaf.dtype)) for leaf in leaves)
        what = (args[:statics], tree, shapes)
        if what not in found:
            key = _key(function, *what)
            found[what] = _load(key, options) or _make(key, function, args[:statics], tree, leaves, options)
        return found[what](leaves)

    return call


def _key(function, statics, tree, shapes) -> str:
    """Name of a program: whatever its code depends on."""
    parts = (_source(), function.__module__, function.__qualname__, statics, str(tree), shapes)
    return hashlib.sha256(repr(parts).encode()).hexdigest()


@cache
def _source() -> str:
    """Hash of the package's own source and the versions of what it compiles with."""
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).resolve().parents[1].rglob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest() + metadata.version("jax") + metadata.version("jaxlib")


def _make(key: str, function, statics, tree, leaves, options) -> Callable[..., Any]:
    """Trace a program, keep it, and return it."""
    import jax
    from jax import export

    shape_of: list[Any] = []

    def flat(given):
        out, structure = jax.tree.flatten(function(*statics, *jax.tree.unflatten(tree, given)))
        shape_of.append(structure)
        return out

    exported = export.export(jax.jit(flat))([jax.ShapeDtypeStruct(v.shape, v.dtype) for v in leaves])
    _store(_place(key), pickle.dumps((bytes(exported.serialize()), shape_of[0])))
    return _runner(exported, shape_of[0], options)


def _load(key: str, options) -> Callable[..., Any] | None:
    """The program of a key, if there is a sound one."""
    import jax
    from jax import export

    try:
        text, structure = pickle.loads(_place(key).read_bytes())
        exported = export.deserialize(bytearray(text))
    except Exception:  # missing or damaged, whatever that raises: tracing anew mends it
        return None
    # A program calls LAPACK by names that JAX registers when it lowers such a call for the first time.
    jax.jit(jax.scipy.linalg.lu_factor).lower(jax.ShapeDtypeStruct((1, 1), float))
    return _runner(exported, structure, options)


def _runner(exported, structure, options) -> Callable[..., Any]:
    """The compiled program on leaves."""
    import jax

    compiled = jax.jit(exported.call, compiler_options=options)
    return lambda leaves: jax.tree.unflatten(structure, compiled(leaves))


def _place(key: str) -> Path:
    """File of a program."""
    return cache_dir() / "programs" / f"{key}.bin"


def _store(path: Path, text: bytes) -> None:
    """Write a file whole or not at all; a folder that cannot be written costs only the next process's time."""
    part = path.with_suffix(f".{os.getpid()}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        part.write_bytes(text)
        os.replace(part, path)
    except OSError:
        with suppress(OSError):
            part.unlink()
