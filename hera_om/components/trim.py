"""Equilibrium of forces and moments: an implicit balance for a solver, residuals for an optimiser."""

import numpy as np
import openmdao.api as om

from hera_om.aircraft.definition import Aircraft
from hera_om.core.registry import quantity

GRAVITY = 9.80665  # m/s^2, ICAO Doc 7488
RAD = np.pi / 180
ALPHA_BOUNDS = (-10.0, 20.0)  # deg: the solver's; what the model holds for is told by the lift margin
PITCH_BOUNDS = (0.0, 85.0)  # deg: blade pitch where the definition gives no bounds
Bounds = dict[str, tuple[float, float]]
_DIMENSIONLESS = ("CX", "CZ", "Cm")


def state_bounds(aircraft: Aircraft, powered: bool) -> dict[str, tuple[float, float]]:
    """Bounds (deg) of the states that a trim of this aircraft may move, in the order of its balances.

    Incidence balances lift; the elevator, if there is one, the pitching moment; blade pitch, if powered,
    thrust and its split.
    """
    out = {"alpha": ALPHA_BOUNDS}
    if aircraft.htail is not None and aircraft.htail.control.elevator is not None:
        limit = aircraft.htail.control.elevator.limit_deg
        out["delta_e"] = (-limit, limit)
    for rotor in aircraft.rotor if powered else ():
        low, high = rotor.beta75_min_deg, rotor.beta75_max_deg
        out[f"theta_{rotor.name}"] = (
            PITCH_BOUNDS[0] if low is None else low,
            PITCH_BOUNDS[1] if high is None else high,
        )
    return out


def narrowed(bounds: Bounds, within: Bounds) -> Bounds:
    """Bounds by name, where given no wider than others."""
    free = (-np.inf, np.inf)
    pairs = {n: (b, within.get(n, free)) for n, b in bounds.items()}
    return {n: (max(a[0], b[0]), min(a[1], b[1])) for n, (a, b) in pairs.items()}


def start_values(aircraft: Aircraft) -> dict[str, float]:
    """Values of all trim states in the definition, deg."""
    flight = aircraft.flight
    return {
        "alpha": flight.alpha_deg,
        "delta_e": flight.delta_e_deg,
        **{f"theta_{r.name}": r.beta75_deg for r in aircraft.rotor},
    }


def balances(CX, CZ, Cm, *, alpha, weight_coefficient, powered: bool) -> dict[str, tuple[float, dict[str, float]]]:
    """Residuals of steady level flight at a load factor, and their derivatives.

    Weight acts along -u, u = (-sin a, 0, cos a) being normal to the flight path in geometry axes:
    CX + C_W sin a = 0, CZ - C_W cos a = 0, Cm = 0. Without power only lift is balanced:
    CZ cos a - CX sin a - C_W = 0. `weight_coefficient` C_W = n m g / (q S); `alpha` in rad.

    Returns:
        ``{state: (residual, {CX, CZ, Cm, alpha, CW: derivative})}``, keyed by the state that closes it.
    """
    s, c, w = np.sin(alpha), np.cos(alpha), weight_coefficient
    moment = (Cm, {"Cm": 1.0})
    if not powered:
        lift = CZ * c - CX * s - w
        return {
            "alpha": (lift, {"CZ": c, "CX": -s, "CW": -1.0, "alpha": -CZ * s - CX * c}),
            "delta_e": moment,
        }
    return {
        "alpha": (CZ - w * c, {"CZ": 1.0, "CW": -c, "alpha": w * s}),
        "delta_e": moment,
        "thrust": (CX + w * s, {"CX": 1.0, "CW": s, "alpha": w * c}),
    }


class _Equilibrium:
    """Inputs, residuals and partials that both components share."""

    def declare_inputs(self, component, aircraft: Aircraft, powered: bool) -> None:
        self.states = tuple(state_bounds(aircraft, powered))
        self.powered = powered
        self.thetas = tuple(s for s in self.states if s.startswith("theta_"))
        design = {f"theta_{r.name}": r.thrust_design_N for r in aircraft.rotor}
        self.design = [design[t] or 1.0 for t in self.thetas]
        for name in _DIMENSIONLESS:
            component.add_input(name, val=0.0, desc=quantity(name).desc)
        component.add_input("mass", val=1.0, units="kg", desc="mass that lift carries")
        component.add_input("q_S", val=1.0, units="N", desc="dynamic pressure times reference area")
        component.add_input("load_factor", val=1.0, desc="load factor normal to the flight path")
        for theta in self.thetas:
            name = theta.replace("theta_", "thrust_")
            component.add_input(name, val=0.0, units="N", desc=quantity(name).desc)

    def evaluate(self, inputs, alpha: float):
        """Residual and derivatives by input for each state."""
        n, mass, q_S = (float(inputs[k][0]) for k in ("load_factor", "mass", "q_S"))
        w = n * mass * GRAVITY / q_S
        values = {k: float(inputs[k][0]) for k in _DIMENSIONLESS}
        rows = balances(**values, alpha=alpha * RAD, weight_coefficient=w, powered=self.powered)
        out = {}
        for state, (value, by) in rows.items():
            key = self.thetas[0] if state == "thrust" else state
            if key not in self.states:
                continue
            row = {k: by[k] for k in _DIMENSIONLESS if k in by}
            if "CW" in by:
                row |= {
                    "mass": by["CW"] * w / mass,
                    "q_S": -by["CW"] * w / q_S,
                    "load_factor": by["CW"] * w / n,
                }
            if "alpha" in by:
                row["alpha"] = by["alpha"] * RAD
            out[key] = (value, row)
        for theta, design in zip(self.thetas[1:], self.design[1:], strict=True):
            first, own = (t.replace("theta_", "thrust_") for t in (self.thetas[0], theta))
            value = float(inputs[own][0]) / design - float(inputs[first][0]) / self.design[0]
            out[theta] = (value, {own: 1.0 / design, first: -1.0 / self.design[0]})
        return out


class TrimBalance(om.ImplicitComponent):
    """States of trim as outputs, balances as residuals; thrusts keep the ratio of their design values."""

    def initialize(self) -> None:
        """Declare options."""
        self.options.declare("aircraft", types=Aircraft, desc="definition of the aircraft")
        self.options.declare("powered", types=bool, default=True, desc="balance thrust too, by blade pitch")
        text = "narrower bounds by state, deg: the box of a surrogate"
        self.options.declare("within", types=dict, default={}, desc=text)

    def setup(self) -> None:
        """Inputs, bounded states, partials."""
        aircraft = self.options["aircraft"]
        self.equilibrium = _Equilibrium()
        self.equilibrium.declare_inputs(self, aircraft, self.options["powered"])
        start = start_values(aircraft)
        bounds = state_bounds(aircraft, self.options["powered"])
        for name, (low, high) in narrowed(bounds, self.options["within"]).items():
            self.add_output(name, val=start[name], lower=low, upper=high, units="deg", desc=quantity(name).desc)
        self.declare_partials("*", "*")

    def apply_nonlinear(self, inputs, outputs, residuals) -> None:
        """Balances."""
        for name, (value, _) in self.equilibrium.evaluate(inputs, float(outputs["alpha"][0])).items():
            residuals[name] = value

    def linearize(self, inputs, outputs, jacobian) -> None:
        """Derivatives of the balances."""
        for name, (_, by) in self.equilibrium.evaluate(inputs, float(outputs["alpha"][0])).items():
            for wrt, value in by.items():
                jacobian[name, wrt] = value


class TrimResiduals(om.ExplicitComponent):
    """The same balances as outputs, for an optimiser that closes them as equality constraints (Table 4)."""

    def initialize(self) -> None:
        """Declare options."""
        self.options.declare("aircraft", types=Aircraft, desc="definition of the aircraft")

    def setup(self) -> None:
        """Inputs, one residual for each balance, partials. The split of thrust is left free."""
        aircraft = self.options["aircraft"]
        self.equilibrium = _Equilibrium()
        self.equilibrium.declare_inputs(self, aircraft, bool(aircraft.rotor))
        self.add_input("alpha", val=aircraft.flight.alpha_deg, units="deg", desc=quantity("alpha").desc)
        self.kept = [s for s in self.equilibrium.states if s not in self.equilibrium.thetas[1:]]
        for state in self.kept:
            self.add_output(f"balance_{_NAMES.get(state, 'x')}", desc=f"balance closed by {state}, load coefficient")
        self.declare_partials("*", "*")

    def compute(self, inputs, outputs) -> None:
        """Balances."""
        rows = self.equilibrium.evaluate(inputs, float(inputs["alpha"][0]))
        for state in self.kept:
            outputs[f"balance_{_NAMES.get(state, 'x')}"] = rows[state][0]

    def compute_partials(self, inputs, partials) -> None:
        """Derivatives of the balances."""
        rows = self.equilibrium.evaluate(inputs, float(inputs["alpha"][0]))
        for state in self.kept:
            for wrt, value in rows[state][1].items():
                partials[f"balance_{_NAMES.get(state, 'x')}", wrt] = value


_NAMES = {"alpha": "z", "delta_e": "m"}
