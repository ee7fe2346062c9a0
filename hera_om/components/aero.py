"""Lattice and rotors as one component: meshes and slipstreams never cross its border."""

from collections import OrderedDict
from typing import Any, NamedTuple

import numpy as np
import openmdao.api as om

from hera_om.components import arrays
from hera_om.components.aero_outputs import Values
from hera_om.components.aero_plan import COEFFICIENTS, TEXTS, AeroPlan
from hera_om.components.aero_stages import RAD, READS, begin, conditions, stages
from hera_om.components.base import JaxComponent, fill_partials
from hera_om.core.programs import in_background
from hera_om.physics.coupling import System, of_a_rotor
from hera_om.physics.equilibrium import Known

# What the factorised system reads, beside the disks and the Mach number.
GEOMETRY = ("wing", "htail", "vtail", "surface", "fuselage", "lattice")


class Aerodynamics(JaxComponent):
    """Coefficients, drag build-up, power-on derivatives and loads at one flight condition.

    Evaluation has two stages: assembly and factorisation, which read geometry and Mach number, are kept while
    those stand still; the state (incidence, rates, controls, blade pitch, altitude, moment point) is then
    cheap.

    With the option ``lateral`` both halves of the aircraft are solved: sideslip, roll and yaw rate, aileron and
    rudder become inputs, side force, rolling and yawing moment and all derivatives by them outputs.

    While `states_only` is set, `compute_partials` fills in only what a trim needs, the balances by incidence,
    elevator and blade pitch, from derivatives that `compute` has found anyway. `pressure` holds what the last
    evaluation found on the panels, see `physics.aerodynamics.AeroResult`; only pictures need it.
    """

    READS = READS
    states_only = False

    def initialize(self) -> None:
        """Declare options."""
        super().initialize()
        self.options.declare("lateral", types=bool, default=False, desc="whether the two halves may differ")

    def declare(self) -> None:
        """Condition and controls in; coefficients, derivatives, rotors and loads out."""
        aircraft = self.options["aircraft"]
        self.statics = AeroPlan(aircraft, self.options["lateral"])
        self.constants = tuple(arrays.grids(aircraft, self.options["lateral"]))
        for name, value in conditions(aircraft, self.statics).items():
            self.add(name, val=value)
        self.add("load_factor", val=1.0, desc="load factor; beyond 1 a steady pull-up adds its pitch rate to q_hat")
        for name, shape in self.statics.outputs(aircraft).items():
            self.add(name, shape=shape, **TEXTS.get(name, {}))

    def begin(self) -> None:
        """Start on single conditions, whose code is kept."""
        if self.statics.model.lateral:
            begin(self.options["aircraft"])

    def begin_partials(self) -> None:
        """Start on assembly and state too, since derivatives are taken where these have been found."""
        values = self.declared()
        compiled, given = stages(self.statics.model.lateral), (*self._static(), self.base, self.constants)
        columns = self._columns(values)

        def work() -> None:
            system = compiled.assemble.begin(*given, values)
            _, known = compiled.settle.begin(*given, system, values, compiled.root.begin(*given, system, values))
            tangents = compiled.by_system.begin(*self._static(), columns[1], *given[3:], values)
            compiled.by_input.begin(*self._static(), *columns, *given[3:], system, known, values, tangents)

        in_background(work)

    def compute(self, inputs, outputs) -> None:
        """Assemble if geometry or Mach number have moved, then evaluate the state."""
        kept = self._state(self.values(inputs))
        self.store(kept.outputs, outputs)
        self._within_range(kept)
        self.pressure = np.asarray(kept.pressure)

    def store(self, out: Values, outputs) -> None:
        """Copy results, unless lattice and rotors have found no equilibrium."""
        super().store(out, outputs)
        if float(out["coupling_residual"]) > UNCONVERGED:
            raise om.AnalysisError(
                f"{self.pathname}: lattice and rotors have not converged "
                f"(residual {float(out['coupling_residual']):.1e} "
                f"of the flight speed, limit {UNCONVERGED:.0e})"
            )

    def _within_range(self, kept: "State") -> None:
        """Surfaces stand in no slipstream that is faster than the model holds for."""
        rotors, found = self.statics.rotors, np.asarray(kept.known.root.flat)
        if rotors is None or kept.system.lattice is None or not found.size:
            return
        fastest = 1.0 + 2.0 * np.max(found.reshape(-1, of_a_rotor(rotors))[:, : rotors.radial])
        if fastest > FASTEST:
            raise om.AnalysisError(
                f"{self.pathname}: slipstreams have {fastest:.1f} times the flight speed, limit {FASTEST:g}: "
                "fly faster or with less thrust"
            )

    def compute_partials(self, inputs, partials) -> None:
        """Exact derivatives by all inputs, or those of the balances alone, see `states_only`."""
        values = self.values(inputs)
        kept = self._state(values)
        if self.states_only:
            self._balances(partials, kept)
            return
        compiled, static = stages(self.statics.model.lateral), self._static()
        names, fixed, moving = self._columns(values)
        tangents = _keep(
            _tangents,
            (*self._system_key(values), fixed),
            lambda: compiled.by_system(*static, fixed, self.base, self.constants, values),
        )
        args = (self.base, self.constants, kept.system, kept.known, values)
        matrix = compiled.by_input(*static, names, fixed, moving, *args, tangents)
        fill_partials(partials, np.asarray(matrix), names, {n: np.zeros(1) for n in fixed + moving}, self._outputs)

    def _balances(self, partials, kept: "State") -> None:
        """Partials of the balances by the trim's states, per degree, from derivatives among the outputs."""
        states = ("alpha", "delta_e", *(f"theta_{g}" for g in self.statics.groups))
        for wrt, column in ((n, i) for i, n in enumerate(self.statics.columns) if n in states):
            for of in COEFFICIENTS:
                partials[of, wrt] = float(getattr(kept.by, of)[column]) * RAD
            for i, group in enumerate(self.statics.groups):
                members = self.statics.running(i, 1)
                partials[f"thrust_{group}", wrt] = float(np.mean(np.asarray(kept.thrust_by)[members, column])) * RAD

    def _columns(self, values: Values) -> tuple[tuple[str, ...], ...]:
        """Outputs, inputs that the factorised system depends on, and the other inputs."""
        names, fixed = tuple(sorted(self._var_rel_names["output"])), self._fixed_names()
        return names, fixed, tuple(n for n in sorted(values) if n not in fixed)

    def _fixed_names(self) -> tuple[str, ...]:
        """Inputs that the factorised system depends on."""
        reads = [n for n, path in self.paths.items() if path.split(".")[0] in (*GEOMETRY, "rotor", "blade", "flight")]
        turning = ["alpha"] if self.statics.model.stream_wake else []
        return tuple(sorted([*reads, "mach", *turning]))

    def _static(self) -> tuple[Any, ...]:
        return self.structure, self.statics, tuple(self.paths.items())

    def _system_key(self, values: Values) -> tuple[Any, ...]:
        """What the factorised system depends on."""
        read = tuple((n, float(values[n])) for n in self._fixed_names())
        return self.structure, self.statics, self.base.tobytes(), read

    def _state(self, values: Values) -> "State":
        """The state at these inputs: evaluated, or kept from the last few calls of any instance."""
        compiled, key = stages(self.statics.model.lateral), self._system_key(values)
        given = (self._static(), self.base, self.constants)

        def evaluate() -> State:
            system = _keep(_systems, key, lambda: compiled.assemble(*given[0], *given[1:], values))
            known, found = compiled.state(*given, system, values)
            return State(found.outputs, system, known, found.by, found.thrust_by, found.pressure)

        return _keep(_states, (*key, tuple((n, float(v)) for n, v in sorted(values.items()))), evaluate)


class State(NamedTuple):
    """What one evaluation leaves for its outputs and its derivatives."""

    outputs: Values
    system: System
    known: Known  # what carries derivatives through the equilibrium
    by: Any  # Coefficients by the state
    thrust_by: Any
    pressure: Any  # see `physics.aerodynamics.AeroResult`


UNCONVERGED = 1e-9  # of the flight speed: residual of the coupling above which an analysis has failed
FASTEST = 3.0  # times the flight speed: speed of a slipstream beyond which `finite_jet` is useless
KEPT = 4
_systems: OrderedDict[Any, System] = OrderedDict()
_states: OrderedDict[Any, State] = OrderedDict()
_tangents: OrderedDict[Any, System] = OrderedDict()


def _keep(store: OrderedDict, key, make):
    """The value of a key, made if it is not among the last few."""
    if key not in store:
        store[key] = make()
        while len(store) > KEPT:
            store.popitem(last=False)
    store.move_to_end(key)
    return store[key]
