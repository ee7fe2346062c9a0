"""Training of a surrogate for the aerodynamics: plan, samples, models, file."""

from collections.abc import Callable
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np
import openmdao.api as om

from hera_om.aircraft import Aircraft, definition_hash, variable_box
from hera_om.components.aero import Aerodynamics
from hera_om.components.mass import MassProperties
from hera_om.components.surrogate import derived, interface, sampled_inputs
from hera_om.core.errors import AnalysisFailure
from hera_om.surrogates import latin_hypercube, save
from hera_om.surrogates import train as fit

Progress = Callable[[int, int, float], None]

UNSEEN = 0.2  # of the samples are kept back to judge the models
# Box of the states around the definition: degrees for angles, metres for the centre of gravity.
ALPHA = (-1.0, 10.0)
ELEVATOR = (-10.0, 10.0)
PITCH_REACH = 5.0
CG_REACH = {"x_cg": 0.30, "z_cg": 0.10}
LEAST_KEPT = 0.9  # of the samples must have been analysed


def training_hash(aircraft: Aircraft) -> str:
    """Hash of everything that a surrogate of this aircraft depends on."""
    return definition_hash(aircraft)


def sample_box(aircraft: Aircraft) -> dict[str, tuple[float, float]]:
    """Bounds of every sampled input, in the units of the component's inputs."""
    names = [name for kind, name, _ in interface(aircraft) if kind == "input"]
    box, out = variable_box(aircraft), {}
    bounds = dict(zip(box.names, zip(box.lower, box.upper, strict=True), strict=True))
    centre = _centre_of_gravity(aircraft)
    pitch = {f"theta_{r.name}": r for r in aircraft.rotor}
    for name in sampled_inputs(aircraft, names):
        if name in bounds:
            out[name] = bounds[name]
        elif name in CG_REACH:
            out[name] = (centre[name] - CG_REACH[name], centre[name] + CG_REACH[name])
        elif name in pitch:
            rotor = pitch[name]
            low, high = rotor.beta75_deg - PITCH_REACH, rotor.beta75_deg + PITCH_REACH
            out[name] = (max(low, rotor.beta75_min_deg or low), min(high, rotor.beta75_max_deg or high))
        else:
            out[name] = {"alpha": ALPHA, "delta_e": ELEVATOR}[name]
    return out


def train(
    aircraft: Aircraft,
    *,
    samples: int = 250,
    seed: int = 0,
    out: str | Path = "surrogate.npz",
    progress: Progress | None = None,
) -> dict[str, Any]:
    """Sample the aerodynamics by a Latin hypercube, train both kinds of models, keep the better one, save.

    Args:
        aircraft: a definition with a wing; its Mach number and altitude are those of the surrogate.
        samples: analyses for training; a fifth more are kept back to judge.
        seed: of the plan and of the training.
        out: file of the surrogate.
        progress: called with the analyses done, their number, and seconds.

    Returns:
        ``path``, ``samples``, ``failed``, ``quality`` (a row for each model of each output), ``shortfalls``,
        seconds.

    Raises:
        AnalysisFailure: more than a tenth of the analyses failed.
    """
    begun, box = perf_counter(), sample_box(aircraft)
    lower, upper = (np.array(side) for side in zip(*box.values(), strict=True))
    unseen = max(2, round(UNSEEN * samples))
    x = np.vstack([latin_hypercube(samples, lower, upper, seed), latin_hypercube(unseen, lower, upper, seed + 1)])
    names, y, kept = _analyse(aircraft, list(box), x, progress)
    if kept.mean() < LEAST_KEPT:
        raise AnalysisFailure(f"{np.sum(~kept)} of {len(kept)} sample analyses failed", where="train")
    seen = np.arange(len(x)) < samples
    sizes = {name: int(np.prod(meta["shape"])) for kind, name, meta in interface(aircraft) if kind == "output"}
    units = {name: meta["units"] for _, name, meta in interface(aircraft)}
    analysed = perf_counter() - begun
    models = fit(
        x[seen & kept],
        y[seen & kept],
        input_names=list(box),
        output_names=names,
        lower=lower,
        upper=upper,
        seed=seed,
        x_test=x[~seen & kept],
        y_test=y[~seen & kept],
        output_sizes=[sizes[n] for n in names],
        input_units=[units[n] for n in box],
        output_units=[units[n] for n in names],
        definition_hash=training_hash(aircraft),
    )
    path = save(models, Path(out))
    return {
        "aircraft": aircraft.name,
        "path": str(path),
        "samples": int(np.sum(seen & kept)),
        "unseen": int(np.sum(~seen & kept)),
        "failed": int(np.sum(~kept)),
        "seconds_analysis": analysed,
        "seconds_total": perf_counter() - begun,
        "shortfalls": models.shortfalls(),
        "quality": models.table(),
    }


def _analyse(aircraft: Aircraft, inputs: list[str], x: np.ndarray, progress: Progress | None):
    """Outputs of the component at every row of x; a row whose analysis failed is marked and left empty."""
    problem = om.Problem(reports=False)
    aero = Aerodynamics(aircraft=aircraft)
    problem.model.add_subsystem("aero", aero, promotes=["*"])
    problem.setup()
    problem.final_setup()
    names = sorted(set(aero._var_rel_names["output"]) - set(derived(aircraft)))
    width = sum(problem.get_val(n).size for n in names)
    y, kept, begun = np.full((len(x), width), np.nan), np.zeros(len(x), bool), perf_counter()
    for i, row in enumerate(x):
        for name, value in zip(inputs, row, strict=True):
            problem.set_val(name, value)
        try:
            problem.run_model()
        except om.AnalysisError:
            continue
        y[i], kept[i] = np.concatenate([problem.get_val(n).ravel() for n in names]), True
        if progress is not None:
            progress(i + 1, len(x), perf_counter() - begun)
    return names, y, kept


def _centre_of_gravity(aircraft: Aircraft) -> dict[str, float]:
    """Centre of gravity of the baseline; the moment point where there are no masses."""
    problem = om.Problem(reports=False)
    if aircraft.mass:
        problem.model.add_subsystem("mass", MassProperties(aircraft=aircraft), promotes=["*"])
    else:
        problem.model.add_subsystem("aero", Aerodynamics(aircraft=aircraft), promotes=["*"])
    problem.setup()
    problem.final_setup()
    if aircraft.mass:
        problem.run_model()
    return {n: float(problem.get_val(n)[0]) for n in CG_REACH}
