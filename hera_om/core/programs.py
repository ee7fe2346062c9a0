"""Stages kept on disk as compiled code, so that the next process neither traces nor compiles them.

JAX's own cache keeps compiled code too, but has the Python functions traced first and takes a second to find what it
keeps. A kept program is found again by the source of the package, the versions, the kind of processor, the static
arguments and the shapes. Only a process that says so (`keep`) uses them: one that changes functions or constants at
run time must not. Loading and compiling leave Python's lock alone: what is begun early runs beside the imports.
"""

import hashlib
import os
import pickle
import platform
import threading
import zlib
from collections.abc import Callable
from concurrent.futures import Future
from contextlib import suppress
from functools import cache, cached_property, partial
from importlib import metadata
from pathlib import Path
from typing import Any, NamedTuple
from uuid import uuid4

from hera_om.core.precision import cache_dir

LEAN = {"xla_cpu_use_fusion_emitters": False}
"""XLA's options for long programs: its older emitters compile them in two thirds of the time and most run no slower."""
FAST = LEAN | {"xla_backend_optimization_level": 0}
"""For what runs once or twice a process: compiled in a third of the time, and runs twice as long."""

_kept = False
_pending: set[Future[Any]] = set()


def keep() -> None:
    """Let this process keep and find programs."""
    global _kept
    _kept = True


def kept() -> bool:
    """Whether this process keeps programs."""
    return _kept


def busy() -> bool:
    """Whether something is being loaded or compiled: a process that ends normally now may crash on its way out."""
    return bool(_pending)


def jitted(function: Callable[..., Any], static: tuple[int, ...], options: dict[str, Any] = LEAN) -> Any:
    """A function compiled for this process alone; the partial keeps JAX from sharing traces with earlier wrappers."""
    import jax

    return jax.jit(partial(function), static_argnums=static, compiler_options=_known(tuple(options.items())))


@cache
def _known(options: tuple[tuple[str, Any], ...]) -> dict[str, Any]:
    """Those options that this build of XLA knows: they come and go, and none is worth a failure."""
    import jax

    trial = jax.jit(lambda: 0.0).lower()
    known = {}
    for name, value in options:
        with suppress(Exception):  # of whatever kind the build raises
            trial.compile({name: value})
            known[name] = value
    return known


def in_background(work: Callable[[], Any]) -> Future[Any]:
    """Run something on a thread that does not keep the process alive; what it raises stands in the future."""
    future: Future[Any] = Future()
    _pending.add(future)

    def run() -> None:
        try:
            result = work()
        except BaseException as error:
            _pending.discard(future)
            future.set_exception(error)
        else:
            _pending.discard(future)
            future.set_result(result)

    threading.Thread(target=run, daemon=True).start()
    return future


class _Entry(NamedTuple):
    """A program on its way: its results, as shapes with their tree, and the compiled function of leaves."""

    tree: Any
    shapes: list[Any]
    compiled: Future[Callable[..., Any]]


class Program:
    """A jitted function whose compiled code is kept on disk, if this process keeps any.

    Args:
        function: pure function of pytrees.
        statics: how many leading arguments are static; their ``repr`` must say all that matters.
        options: of XLA, for this function alone.
    """

    def __init__(self, function: Callable[..., Any], statics: int, options: dict[str, Any] = LEAN) -> None:
        self._function, self._statics, self._options = function, statics, options
        self._entries: dict[Any, Future[_Entry]] = {}
        self._lock = threading.Lock()

    @cached_property
    def _jitted(self) -> Any:
        """For processes that keep nothing."""
        return jitted(self._function, tuple(range(self._statics)), self._options)

    def __call__(self, *args: Any) -> Any:
        """The function's result."""
        import jax

        if not _kept:
            return self._jitted(*args)
        entry, leaves = self._entry(args)
        return jax.tree.unflatten(entry.tree, entry.compiled.result()(leaves))

    def begin(self, *args: Any) -> Any:
        """Start to load or to compile the program for arguments of these shapes, in a process that keeps programs.

        Args:
            args: the function's; instead of an array a ``jax.ShapeDtypeStruct`` will do.

        Returns:
            The result's shapes.
        """
        import jax

        entry, _ = self._entry(args)
        return jax.tree.unflatten(entry.tree, entry.shapes)

    def _entry(self, args: tuple[Any, ...]) -> tuple[_Entry, list[Any]]:
        """The program for these arguments, begun by whoever asks first, and their leaves."""
        import jax
        import numpy as np

        statics, given = args[: self._statics], args[self._statics :]
        leaves, tree = jax.tree.flatten(given)
        leaves = [v if isinstance(v, jax.Array | jax.ShapeDtypeStruct) else np.asarray(v) for v in leaves]
        what = (statics, tree, tuple((v.shape, str(v.dtype)) for v in leaves))
        with self._lock:
            first = what not in self._entries
            future = self._entries.setdefault(what, Future())
        if first:
            try:
                future.set_result(self._started(what))
            except BaseException as error:
                del self._entries[what]
                future.set_exception(error)
        return future.result(), leaves

    def _started(self, what: Any) -> _Entry:
        """A program whose code is being loaded, or compiled."""
        path = _place(_key(self._function, *what))
        found = _read(path)
        if found is None:
            traced, tree = self._trace(what)
            shapes = [_shape(v.shape, v.dtype) for v in traced.out_info]
            return _Entry(tree, shapes, in_background(lambda: self._compile(path, traced, tree, shapes)))
        tree, outputs, code = found
        shapes = [_shape(*v) for v in outputs]

        def load() -> Callable[..., Any]:
            try:
                return _load(code)
            except Exception:  # damaged, or of another build of XLA, whatever that raises: making it anew mends it
                return self._compile(path, self._trace(what)[0], tree, shapes)

        return _Entry(tree, shapes, in_background(load))

    def _trace(self, what: Any) -> tuple[Any, Any]:
        """The traced function of leaves, and the tree of its results."""
        import jax

        statics, tree, shapes = what
        structure: list[Any] = []

        def flat(given):
            out, found = jax.tree.flatten(self._function(*statics, *jax.tree.unflatten(tree, given)))
            structure.append(found)
            return out

        # By a name of its own, since JAX's cache would hand back code that loses its symbols when written again.
        flat.__name__ = f"{self._function.__name__}_{uuid4().hex}"
        traced = jax.jit(flat).trace([_shape(*v) for v in shapes])
        return traced, structure[0]

    def _compile(self, path: Path, traced: Any, tree: Any, shapes: list[Any]) -> Callable[..., Any]:
        """Compile a traced function, and keep it."""
        from jax.experimental import serialize_executable

        compiled = traced.lower().compile(_known(tuple(self._options.items())))
        code = pickle.dumps(serialize_executable.serialize(compiled))
        outputs = [(v.shape, str(v.dtype)) for v in shapes]
        _store(path, pickle.dumps((tree, outputs, zlib.compress(code, 1))))
        return compiled


def _shape(shape: tuple[int, ...], dtype: Any) -> Any:
    """A shape as JAX wants it."""
    import jax

    return jax.ShapeDtypeStruct(shape, dtype)


def _key(function, statics, tree, shapes) -> str:
    """Name of a program: whatever its code depends on."""
    parts = (_source(), _processor(), function.__module__, function.__qualname__, statics, str(tree), shapes)
    return hashlib.sha256(repr(parts).encode()).hexdigest()


@cache
def _source() -> str:
    """Hash of the package's own source and the versions of what it compiles with."""
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).resolve().parents[1].rglob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest() + metadata.version("jax") + metadata.version("jaxlib")


@cache
def _processor() -> str:
    """Kind of processor: compiled code uses whatever instructions there are."""
    known = f"{platform.system()} {platform.machine()} {platform.processor()}"
    with suppress(OSError):
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        known += next((line for line in lines if line.startswith(("flags", "Features"))), "")
    return known


def _read(path: Path) -> tuple[Any, list[Any], bytes] | None:
    """Tree and shapes of the results, and the code, if there is a sound file."""
    try:
        tree, outputs, code = pickle.loads(path.read_bytes())
    except Exception:  # missing or damaged, whatever that raises
        return None
    return tree, outputs, code


def _load(code: bytes) -> Callable[..., Any]:
    """The compiled function."""
    from jax.experimental import serialize_executable

    _know_lapack()
    return serialize_executable.deserialize_and_load(*pickle.loads(zlib.decompress(code)))


@cache
def _know_lapack() -> None:
    """Have JAX name LAPACK's functions, which code calls by name: it does so when it first lowers such a call."""
    import jax

    jax.jit(jax.scipy.linalg.lu_factor).lower(_shape((1, 1), float))


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
