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
os.environ["JAX_ENABLE_X64"] = "1"  # tests that import jax before anything of ours, too
os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# The first example of a test compiles, which no deadline should count; CI must give the same verdict twice.
settings.register_profile("hera_om", deadline=None, derandomize=True, max_examples=25)
settings.load_profile("hera_om")


MAPS = 20_000  # memory maps of a process; Linux allows 65 530, and compiled code takes several a kernel


@pytest.fixture(autouse=True, scope="module")
def room_for_code():
    """Compiled code is dropped between modules before a worker runs out of memory maps, which aborts it."""
    yield
    maps = Path("/proc/self/maps")
    if maps.exists() and len(maps.read_bytes().splitlines()) > MAPS:
        import jax

        jax.clear_caches()


@pytest.fixture(scope="session")
def root() -> Path:
    """Root of the checkout."""
    return Path(__file__).resolve().parents[1]


@pytest.fixture(scope="session")
def reference() -> Path:
    """Folder of the reference data: numbers that do not come from our own code."""
    return Path(__file__).resolve().parent / "reference"


# Coarse, so that a test compiles and runs fast; one structure, so that all tests share what is compiled.
SMALL = {
    "lattice.wing_spanwise": 8,
    "lattice.wing_chordwise": 2,
    "lattice.tail_spanwise": 4,
    "lattice.tail_chordwise": 2,
    "lattice.rotor_radial": 4,
    "lattice.rotor_azimuthal": 6,
    "lattice.box_stations": 8,
}


@pytest.fixture(scope="session")
def small_aircraft():
    """Loader of a shipped aircraft on a coarse lattice, with further numbers replaced by path."""
    from hera_om.aircraft import load_aircraft

    def load(name="hera_like", **numbers):
        return load_aircraft(name, SMALL | {path.replace("__", "."): v for path, v in numbers.items()})

    return load


@pytest.fixture(scope="session")
def small(small_aircraft):
    """The DEP aircraft on a coarse lattice."""
    return small_aircraft()


@pytest.fixture(scope="session")
def compilations():
    """Names of JAX's tracing and compiling events of this process, in order; a test looks at what is added."""
    import jax

    seen = []

    def listen(event, seconds, **_):
        if event.startswith("/jax/core/compile/"):
            seen.append(event)

    jax.monitoring.register_event_duration_secs_listener(listen)
    return seen
