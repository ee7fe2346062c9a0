"""The one base class that wraps a jitted physics function as an OpenMDAO component."""

from collections.abc import Mapping
from functools import cache
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import openmdao.api as om
from jax.flatten_util import ravel_pytree

from hera_om.aircraft.definition import Aircraft
from hera_om.components.structure import Structure, number_array, variables_under
from hera_om.core.programs import Program, in_background, kept
from hera_om.core.registry import quantity

Values = dict[str, Any]


class JaxComponent(om.ExplicitComponent):
    """A physics function of the definition's numbers and of named inputs.

    A subclass says what it reads (`READS`: prefixes of definition paths; the design variables under them
    become inputs), adds its own inputs and outputs in `declare`, and gives `evaluate`, a static method
    ``(aircraft, statics, constants, inputs) -> outputs`` of traced values. It is compiled once a process for
    each structure of definition, not once an instance; derivatives are exact and dense, by the cheaper of
    forward and reverse mode.
    """

    READS: tuple[str, ...] = ()
    PIECEWISE: tuple[str, ...] = ()
    """Outputs that jump, such as rounded numbers: they are given no derivatives."""

    def initialize(self) -> None:
        """Declare the definition as the only option that all components share."""
        self.options.declare("aircraft", types=Aircraft, desc="definition of the aircraft")

    def declare(self) -> None:
        """Add inputs and outputs."""
        raise NotImplementedError

    @staticmethod
    def evaluate(aircraft: Aircraft, statics: Any, constants: Any, inputs: Values) -> Values:
        """Outputs by name from traced inputs by name; a subclass gives this, or its own compute."""
        raise NotImplementedError

    def setup(self) -> None:
        """Split the definition and declare everything."""
        aircraft = self.options["aircraft"]
        self.structure = Structure(aircraft)
        self.base = number_array(aircraft)
        self.statics, self.constants = None, ()
        self.paths: dict[str, str] = {}
        self._add_variables(aircraft)
        self.declare()
        if self._var_rel_names["input"] and self._smooth():
            self.declare_partials(list(self._smooth()), "*")
        if kept():
            self.begin()

    def begin(self) -> None:
        """Start to load or compile what `compute` will ask for; a fault waits for the asking."""
        inputs = self.declared()
        function, static = self.call()[0], (self.structure, self.statics, tuple(self.paths.items()))
        in_background(lambda: function.begin(*static, self.base, self.constants, inputs))

    def begin_partials(self) -> None:
        """The same for what `compute_partials` will ask for."""
        jacobian, args = self._partials_call(self.declared())
        in_background(lambda: jacobian.begin(*args))

    def _add_variables(self, aircraft: Aircraft) -> None:
        """Make the design variables that this component reads its inputs."""
        for name, path, value, units in variables_under(aircraft, self.READS):
            self.paths[name] = path
            self.add_input(name, val=value, units=units, desc=f"design variable {path}")

    def add(
        self, name: str, *, shape: tuple[int, ...] = (1,), units: str | None = None, desc: str = "", val=None
    ) -> None:
        """Add an input (with ``val``) or an output (without) by the registry, or by what is given."""
        known = quantity(name) if not desc else None
        units, desc = (known.units, known.desc) if known else (units, desc)
        if val is None:
            self.add_output(name, shape=shape, units=units, desc=desc)
        else:
            start: Any = np.asarray(val, float)
            self.add_input(name, val=start, units=units, desc=desc)

    def values(self, inputs) -> Values:
        """Inputs as float64 arrays by name (Python floats would retrace), single numbers without an axis."""
        arrays = {name: np.asarray(inputs[name], float) for name in self._var_rel_names["input"]}
        return {name: a.reshape(()) if a.size == 1 else a for name, a in arrays.items()}

    def declared(self) -> Values:
        """`values` of the inputs as they were declared."""
        return self.values({name: self._var_rel2meta[name]["val"] for name in self._var_rel_names["input"]})

    def call(self):
        """The compiled function and its compiled Jacobian."""
        return _compiled(type(self).evaluate)

    def compute(self, inputs, outputs) -> None:
        """Evaluate; a value that is not finite is an AnalysisError that names it."""
        function, _, _ = self.call()
        out = function(
            self.structure,
            self.statics,
            tuple(self.paths.items()),
            self.base,
            self.constants,
            self.values(inputs),
        )
        self.store(out, outputs)

    def store(self, out: Values, outputs) -> None:
        """Copy results to OpenMDAO, guarding against what is not finite."""
        bad = [name for name in self._var_rel_names["output"] if not np.all(np.isfinite(out[name]))]
        if bad:
            raise om.AnalysisError(f"{self.pathname}: not finite: {', '.join(bad)}")
        for name in self._var_rel_names["output"]:
            outputs[name] = np.asarray(out[name]).reshape(outputs[name].shape)

    def compute_partials(self, inputs, partials) -> None:
        """Exact dense partials by forward or reverse mode, whichever has fewer passes."""
        values = self.values(inputs)
        jacobian, args = self._partials_call(values)
        fill_partials(partials, np.asarray(jacobian(*args)), self._smooth(), values, self._outputs)

    def _partials_call(self, values: Values) -> tuple[Program, tuple[Any, ...]]:
        """The Jacobian of fewer passes, and its arguments."""
        _, forward, reverse = self.call()
        n_in, names = sum(v.size for v in values.values()), self._smooth()
        n_out = sum(self._var_rel2meta[name]["size"] for name in names)
        static = (self.structure, self.statics, tuple(self.paths.items()), names)
        return forward if n_in <= n_out else reverse, (*static, self.base, self.constants, values)

    def _smooth(self) -> tuple[str, ...]:
        """Outputs that have derivatives."""
        return tuple(name for name in self._var_rel_names["output"] if name not in self.PIECEWISE)


def fill_partials(partials, matrix: np.ndarray, names, values: Mapping[str, np.ndarray], outputs) -> None:
    """Cut a dense Jacobian into OpenMDAO's blocks; its rows and columns go by the alphabet of the names."""
    row = 0
    for of in sorted(names):
        height, column = outputs[of].size, 0
        for wrt in sorted(values):
            width = values[wrt].size
            partials[of, wrt] = matrix[row : row + height, column : column + width]
            column += width
        row += height


@cache
def _compiled(evaluate):
    """Value, forward and reverse Jacobian of an ``evaluate``, compiled once a process."""

    def run(structure: Structure, statics, paths, base, constants, inputs: Values) -> Values:
        changes = {path: inputs[name] for name, path in paths}
        return evaluate(structure.aircraft(base, changes), statics, constants, inputs)

    def jacobian(mode):
        def matrix(structure, statics, paths, names, base, constants, inputs):
            flat, unravel = ravel_pytree(jax.tree.map(jnp.asarray, inputs))

            def flat_run(v):
                out = run(structure, statics, paths, base, constants, unravel(v))
                return ravel_pytree({name: out[name] for name in names})[0]

            return mode(flat_run)(flat)

        matrix.__module__, matrix.__qualname__ = evaluate.__module__, f"{evaluate.__qualname__}, {mode.__name__}"
        return Program(matrix, 4)

    run.__module__, run.__qualname__ = evaluate.__module__, evaluate.__qualname__  # names of the kept programs
    return Program(run, 3), jacobian(jax.jacfwd), jacobian(jax.jacrev)
