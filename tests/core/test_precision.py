"""float64 and the disk cache, each in a process of its own: JAX is configured once a process."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from hera_om.core import precision

COMPILE = """
import hera_om.physics
import jax, jax.numpy as jnp
y = jax.jit(lambda x: jnp.sin(x) * 3.25 + x**2)(jnp.linspace(0.0, 1.0, 7))
print(y.dtype, jnp.asarray(0.1).dtype, jax.default_backend())
"""


def _run(code: str, **variables: str) -> subprocess.CompletedProcess:
    """Run code in a fresh interpreter with these environment variables on top of ours."""
    return subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, **variables},
        cwd=Path(precision.__file__).parents[2],
        capture_output=True,
        text=True,
        check=True,
    )


def test_physics_computes_in_float64_on_the_cpu(tmp_path):
    done = _run(COMPILE, HERA_OM_CACHE=str(tmp_path), JAX_ENABLE_X64="0")
    assert done.stdout.split() == ["float64", "float64", "cpu"]


def test_short_compiles_are_cached_and_reused(tmp_path):
    def entries() -> set[str]:
        return {path.name for path in (tmp_path / "xla").iterdir() if path.name.endswith("-cache")}

    _run(COMPILE, HERA_OM_CACHE=str(tmp_path))
    first = entries()
    assert first, "a compile of some milliseconds was not kept"
    _run(COMPILE, HERA_OM_CACHE=str(tmp_path))
    assert entries() == first, "the second process compiled again"


def test_a_cache_that_cannot_be_written_costs_only_the_cache(tmp_path):
    occupied = tmp_path / "file"
    occupied.write_text("not a folder")
    done = _run(COMPILE, HERA_OM_CACHE=str(occupied))
    assert done.stdout.split()[0] == "float64"
    assert occupied.read_text() == "not a folder"


def test_a_cache_entry_cut_short_costs_only_a_compile(tmp_path):
    _run(COMPILE, HERA_OM_CACHE=str(tmp_path))
    for entry in (tmp_path / "xla").glob("*-cache"):
        entry.write_bytes(entry.read_bytes()[:100])
    done = _run(COMPILE, HERA_OM_CACHE=str(tmp_path))
    assert done.stdout.split()[0] == "float64"


@pytest.mark.parametrize(
    ("variables", "expected"),
    [
        ({"HERA_OM_CACHE": "/a/chosen", "XDG_CACHE_HOME": "/a/xdg"}, "/a/chosen"),
        ({"HERA_OM_CACHE": "", "XDG_CACHE_HOME": "/a/xdg"}, "/a/xdg/hera_om"),
        ({"HERA_OM_CACHE": "", "XDG_CACHE_HOME": "", "HOME": "/a/user"}, "/a/user/.cache/hera_om"),
    ],
)
def test_the_cache_folder_follows_the_environment(monkeypatch, variables, expected):
    for name, value in variables.items():
        monkeypatch.setenv(name, value)
    assert precision.cache_dir() == Path(expected)
