"""Derivatives whose code is begun before they are asked for: what is begun is what the asking waits for."""

from time import sleep

import jax
import numpy as np
import openmdao.api as om
import pytest

from hera_om.aircraft import load_aircraft
from hera_om.components import aero, aero_stages, base
from hera_om.components.aero import Aerodynamics
from hera_om.components.performance import Performance
from hera_om.core import programs
from hera_om.core.precision import enable


def partials(component, begun):
    """Partials of a component, begun early or not."""
    problem = om.Problem(reports=False)
    problem.model.add_subsystem("own", component, promotes=["*"])
    problem.setup()
    problem.final_setup()
    if begun:
        component.begin_partials()
    problem.run_model()
    of, wrt = (sorted(component._var_rel_names[kind]) for kind in ("output", "input"))
    return problem.compute_totals(of, wrt)


def bare(reference):
    """A wing without its propeller."""
    aircraft = load_aircraft(reference / "tud_model_II.toml")
    coarse = aircraft.lattice.model_copy(update={"wing_spanwise": 6})
    return aircraft.model_copy(update={"rotor": (), "blade": (), "lattice": coarse})


def as_in_a_new_process():
    """Forget what has been compiled and found."""
    base._compiled.cache_clear()
    aero_stages.stages.cache_clear()
    for store in (aero._systems, aero._states, aero._tangents):
        store.clear()


@pytest.mark.parametrize("kind", [Performance, Aerodynamics])
def test_derivatives_begun_early(kind, reference, tmp_path, monkeypatch):
    aircraft = bare(reference) if kind is Aerodynamics else load_aircraft("hera_like")
    plain = partials(kind(aircraft=aircraft), begun=False)
    monkeypatch.setenv("HERA_OM_CACHE", str(tmp_path))
    monkeypatch.setattr(programs, "_kept", True)
    enable()
    files = []
    for begun in (False, True):
        as_in_a_new_process()
        found = partials(kind(aircraft=aircraft), begun)
        jax.tree.map(lambda a, b: np.testing.assert_allclose(a, b, rtol=1e-9, atol=1e-12), found, plain)
        while programs.busy():
            sleep(0.01)
        files.append(sorted(path.name for path in (tmp_path / "programs").iterdir()))
    assert files[0] == files[1]  # nothing is begun that is not asked for
    as_in_a_new_process()
