"""The one place where JAX is configured: float64, CPU, and a compilation cache on disk."""

import os
from pathlib import Path

_enabled = False


def cache_dir() -> Path:
    """Folder of the compilation cache: ``$HERA_OM_CACHE`` or ``hera_om`` in the user's cache folder."""
    chosen = os.environ.get("HERA_OM_CACHE")
    if chosen:
        return Path(chosen)
    return Path(os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache") / "hera_om"


def enable() -> None:
    """Switch float64 and the disk cache on; call it before the first JAX array is made.

    The cache also keeps compiles of under a second: a design point has dozens of them. A folder that
    cannot be written costs only the cache, never the run.
    """
    global _enabled
    if _enabled:
        return
    import jax

    jax.config.update("jax_enable_x64", True)
    jax.config.update(
        "jax_traceback_in_locations_limit", 1
    )  # whole tracebacks in compiled code cost time, nobody reads them
    jax.config.update("jax_platforms", os.environ.get("JAX_PLATFORMS") or "cpu")
    folder = cache_dir() / "xla"
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        pass
    else:
        jax.config.update("jax_compilation_cache_dir", str(folder))
        jax.config.update("jax_persistent_cache_min_compile_time_secs", 0.0)
        jax.config.update("jax_persistent_cache_min_entry_size_bytes", -1)
    _enabled = True
