"""What every test needs before the first heavy import, and the fixtures that several folders share."""

import atexit
import os
import shutil
import tempfile
from pathlib import Path

import pytest
from hypothesis import settings

# One folder a process: xdist's workers would otherwise write into each other's OpenMDAO outputs.
_workdir = tempfile.mkdtemp(prefix="hera_om_tests_")
atexit.register(shutil.rmtree, _workdir, ignore_errors=True)

os.environ["OPENMDAO_WORKDIR"] = _workdir
os.environ["OPENMDAO_REPORTS"] = "0"
os.environ["MPLBACKEND"] = "Agg"
os.environ["JAX_PLATFORMS"] = "cpu"
os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# The first example of a test compiles, which no deadline should count; CI must give the same verdict twice.
settings.register_profile("hera_om", deadline=None, derandomize=True, max_examples=25)
settings.load_profile("hera_om")


@pytest.fixture(scope="session")
def root() -> Path:
    """Root of the checkout."""
    return Path(__file__).resolve().parents[1]


@pytest.fixture(scope="session")
def reference() -> Path:
    """Folder of the reference data: numbers that do not come from our own code."""
    return Path(__file__).resolve().parent / "reference"
