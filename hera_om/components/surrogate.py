"""A trained surrogate in the place of the lattice and the rotors, behind the same inputs and outputs."""

from functools import lru_cache

import jax
import jax.numpy as jnp
import numpy as np
import openmdao.api as om

from hera_om.aircraft.definition import Aircraft
from hera_om.components.aero import Aerodynamics
from hera_om.components.aero_plan import COEFFICIENTS
from hera_om.components.arrays import flow, reference
from hera_om.physics.performance import pull_up_rate
from hera_om.surrogates import SurrogateSet, outside, predict

RATE = "q_hat"  # enters linearly, by the model's own derivatives
FIXED = ("mach", "altitude", "load_factor", RATE)  # not sampled: the condition is the definition's


def derived(aircraft: Aircraft) -> tuple[str, ...]:
    """Outputs that are not trained: CL / CD, nothing to couple, and thrust times speed over power."""
    return ("L_over_D", "coupling_residual", *(f"eta_{r.name}" for r in aircraft.rotor))


def sampled_inputs(aircraft: Aircraft, names) -> list[str]:
    """Inputs of the aerodynamics that a surrogate is a function of."""
    return [n for n in names if n not in FIXED]


class SurrogateAerodynamics(om.ExplicitComponent):
    """All outputs of `Aerodynamics` from a SurrogateSet, with exact derivatives.

    Mach number and altitude are those it was trained at; any other value, like a point outside the box of the
    samples, is an AnalysisError: a surrogate is not asked where it knows nothing. The pitch rate of a pull-up
    enters the coefficients through the surrogate's own derivatives by q_hat.
    """

    states_only = False  # the lattice's shortcut for Newton's method; a surrogate's derivatives cost nothing

    def initialize(self) -> None:
        """Declare options."""
        self.options.declare("aircraft", types=Aircraft, desc="definition of the aircraft")
        self.options.declare("surrogate", types=SurrogateSet, desc="trained models")

    def setup(self) -> None:
        """The lattice's inputs and outputs."""
        aircraft = self.options["aircraft"]
        for kind, name, meta in interface(aircraft):
            (self.add_input if kind == "input" else self.add_output)(name, **meta)
        self._condition = {"mach": aircraft.flight.mach, "altitude": aircraft.flight.altitude_m}
        stream = flow(aircraft, aircraft.flight.mach, aircraft.flight.altitude_m, jnp.zeros(3))
        self._speed, self._chord = float(stream.speed), float(reference(aircraft)[1])
        self.declare_partials("*", "*")

    def _point(self, inputs) -> np.ndarray:
        """The surrogate's own inputs, checked to lie in its box."""
        found = self.options["surrogate"]
        for name, value in self._condition.items():
            if abs(float(inputs[name][0]) - value) > 1e-9 * max(1.0, abs(value)):
                raise om.AnalysisError(f"{self.pathname}: the surrogate holds at {name} {value:g} only")
        x = np.array([float(inputs[n][0]) for n in found.input_names])
        bad = outside(found, x)
        if bad:
            text = "; ".join(f"{n} = {v:.5g} not in [{low:.5g}, {high:.5g}]" for n, v, low, high in bad)
            raise om.AnalysisError(f"{self.pathname}: outside the box of the surrogate: {text}")
        return x

    def _rate(self, inputs) -> np.ndarray:
        """Pitch rate beyond that of the samples, and load factor."""
        sampled = self.options["aircraft"].flight.q_hat
        return np.array([float(inputs[RATE][0]) - sampled, float(inputs["load_factor"][0])])

    def compute(self, inputs, outputs) -> None:
        """Predict."""
        values = np.asarray(_functions()[0](*self._args(inputs)))
        for name, (start, stop) in self._slices().items():
            outputs[name] = np.reshape(values[start:stop], outputs[name].shape)

    def compute_partials(self, inputs, partials) -> None:
        """Exact derivatives of the prediction."""
        found = self.options["surrogate"]
        names = [*found.input_names, RATE, "load_factor"]
        matrix = np.asarray(_functions()[1](*self._args(inputs)))
        for name, (start, stop) in self._slices().items():
            for j, wrt in enumerate(names):
                partials[name, wrt] = matrix[start:stop, j : j + 1]

    def _args(self, inputs):
        """Arguments of the compiled prediction."""
        found = self.options["surrogate"]
        start = {n: s.start for n, s in found.slices.items()}
        places = np.array([[start[c], start[f"{c}_q"]] for c in COEFFICIENTS])
        ratio = np.array([start["CL"], start["CD"]])
        groups = [r.name for r in self.options["aircraft"].rotor]
        shafts = np.array([[start[f"thrust_{g}"], start[f"power_{g}"]] for g in groups], int).reshape(-1, 2)
        stream = np.array([self._speed, self._chord])
        return found.predictor, self._point(inputs), self._rate(inputs), places, ratio, shafts, stream

    def _slices(self) -> dict[str, tuple[int, int]]:
        """Where each output stands in a prediction: those trained, then those derived."""
        out = {n: (s.start, s.stop) for n, s in self.options["surrogate"].slices.items()}
        end = sum(self.options["surrogate"].output_sizes)
        return out | {n: (end + i, end + i + 1) for i, n in enumerate(derived(self.options["aircraft"]))}


def interface(aircraft: Aircraft) -> list[tuple[str, str, dict]]:
    """Inputs and outputs of `Aerodynamics`: kind, name, arguments of `add_input` or `add_output`."""
    problem, aero = om.Problem(reports=False), Aerodynamics(aircraft=aircraft)
    problem.model.add_subsystem("aero", aero)
    problem.setup()
    keys = ("units", "shape", "desc", "val")
    rows = []
    for name, meta in aero.get_io_metadata(metadata_keys=keys).items():
        kind = "input" if name in aero._var_rel_names["input"] else "output"
        kept = keys if kind == "input" else keys[:3]
        rows.append((kind, name, {k: meta[k] for k in kept if not (k == "shape" and kind == "input")}))
    return rows


@lru_cache(maxsize=1)
def _functions():
    """Prediction and its Jacobian by the surrogate's inputs, q_hat and load factor, compiled once a process."""

    def value(predictor, x, rate, places, ratio, shafts, stream):
        y = predict(predictor, x)
        speed, chord = stream
        turning = rate[0] + pull_up_rate(speed, rate[1]) * chord / (2 * speed)
        y = y.at[places[:, 0]].add(y[places[:, 1]] * turning)
        power = y[shafts[:, 1]]
        eta = jnp.where(power == 0, 0.0, y[shafts[:, 0]] * speed / jnp.where(power == 0, 1.0, power))
        return jnp.concatenate([y, jnp.stack([y[ratio[0]] / y[ratio[1]], jnp.zeros(())]), eta])

    def jacobian(predictor, x, rate, *rest):
        def run(v):
            return value(predictor, v[:-2], v[-2:], *rest)

        return jax.jacfwd(run)(jnp.concatenate([x, rate]))

    return jax.jit(value), jax.jit(jacobian)
