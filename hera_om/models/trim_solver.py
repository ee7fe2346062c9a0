"""Newton's method for a trim, with a diagnosis when there is none."""

import openmdao.api as om

TOLERANCE = 1e-11  # of the balances, which are load coefficients
SURROGATE_TOLERANCE = 1e-7  # the same for a surrogate: rounding in Kriging sums of large weights leaves about 1e-9
MAX_ITERATIONS = 25


class TrimNewton(om.NewtonSolver):
    """Newton's method on the states of a trim point.

    While it runs, the aerodynamics hands over only the derivatives by the states, which it has anyway. When it
    does not converge the AnalysisError says which control stands at its limit and what is left of each balance.
    """

    def __init__(self, aero, balance, tolerance: float = TOLERANCE, **options) -> None:
        super().__init__(solve_subsystems=True, max_sub_solves=MAX_ITERATIONS, **options)
        self._aero, self._balance = aero, balance
        self.options.update({"atol": tolerance, "rtol": 1e-99, "maxiter": MAX_ITERATIONS, "iprint": -1})
        self.options["err_on_non_converge"] = True
        self.linesearch = om.BoundsEnforceLS(bound_enforcement="scalar", print_bound_enforce=False)
        self.linesearch.options["iprint"] = -1

    def solve(self) -> None:
        """Solve, or raise with a diagnosis."""
        self._aero.states_only = True
        try:
            super().solve()
        except om.AnalysisError as error:
            where = self._balance.pathname.rpartition(".")[0] or "trim"
            raise om.AnalysisError(f"{where}: {self._diagnosis()} ({error})") from error
        finally:
            self._aero.states_only = False

    def _diagnosis(self) -> str:
        """Which control is at its limit, and what is left of the balances."""
        stuck = saturated(self._balance)
        left = ", ".join(f"{n} {float(v[0]):+.2e}" for n, v in self._left().items())
        reason = f"saturated: {', '.join(stuck)}" if stuck else "no control at its limit"
        return f"no trim; {reason}; balances left by the state that should close them: {left}"

    def _left(self):
        """Residuals of the balance by state."""
        names = list(self._balance.equilibrium.states)
        return {n: self._balance._residuals[n] for n in names}


def saturated(balance) -> list[str]:
    """States of a trim balance that stand at a bound, with the bound."""
    out = []
    for name, meta in balance._var_rel2meta.items():
        value = float(balance._outputs[name][0]) if name in balance._outputs else None
        for bound in (meta.get("lower"), meta.get("upper")):
            if value is not None and bound is not None and abs(value - float(bound.flat[0])) < 1e-6:
                out.append(f"{name} at {value:.3g} deg")
    return out
