"""Static margin and longitudinal modes from power-on derivatives."""

from typing import Any

import jax.numpy as jnp
import numpy as np

from hera_om.aircraft.definition import Aircraft
from hera_om.components import arrays
from hera_om.components.base import JaxComponent, Values
from hera_om.physics.flight_dynamics import (
    LongitudinalDerivatives,
    SteadyFlight,
    longitudinal_state_matrix,
    neutral_point,
    reduced_order,
)
from hera_om.physics.modes import longitudinal_modes

RAD = np.pi / 180
CX_U_OVER_CD = 2.0  # thrust held: V d/dV of T / (q S) = -2 T / (q S), and T = D
# A conventional aircraft in cruise, so that the component runs before anything is connected to it.
DEFAULTS = {
    "CL": 0.5, "CD": 0.03, "CX_alpha": -0.4, "CZ_alpha": 6.0, "Cm_alpha": -1.2, "CX_q": 0.0, "CZ_q": 9.0,
    "Cm_q": -35.0, "CZ_alphadot": 2.0, "Cm_alphadot": -8.0, "alpha": 1.0, "x_cg": 0.0,
}  # fmt: skip
SLOPES = tuple(n for n in DEFAULTS if n.endswith(("_alpha", "_q", "_alphadot")))


class Stability(JaxComponent):
    """Flying qualities in steady level flight: Eqs. 2-5, and the modes of the full linearised equations.

    The derivatives are power-on and about the centre of gravity. The full equations know the speed by the
    dynamic pressure and by the thrust, which stays constant and acts along x and through the centre of
    gravity: CX_u = 2 CD, as Eq. 5 assumes too. At constant power it would be 3 CD. Effects of the Mach number
    and of the slipstream by the speed are left out (CZ_u = Cm_u = 0).
    """

    def initialize(self) -> None:
        """Declare the options."""
        super().initialize()
        self.options.declare("aircraft", types=Aircraft, check_valid=_complete, desc="definition of the aircraft")

    def setup(self) -> None:
        """The planform matters only where it gives the reference quantities."""
        given = self.options["aircraft"].reference
        derived = given.S_m2 is None or given.c_m is None
        self.READS = ("reference.S_m2", "reference.c_m", *(("wing.section",) if derived else ()))
        super().setup()

    def declare(self) -> None:
        """Derivatives, stream and mass in; margins and modes out."""
        for name, value in DEFAULTS.items():
            self.add(name, val=value)
        self.add("speed", val=150.0, units="m/s", desc="true airspeed")
        self.add("density", val=0.65, units="kg/m**3", desc="density of the air")
        self.add("mass_cruise", val=2e4, units="kg", desc="mass at the start of the cruise")
        self.add("Iyy", val=5e5)
        for name in ("static_margin", "x_np", "omega_sp", "zeta_sp", "omega_ph", "zeta_ph", "CAP"):
            self.add(name)
        for mode, text in (("sp", "short period"), ("ph", "phugoid")):
            self.add(f"omega_{mode}_full", units="rad/s", desc=f"{text} of the full equations, undamped frequency")
            self.add(f"zeta_{mode}_full", desc=f"{text} of the full equations, damping ratio")

    @staticmethod
    def evaluate(aircraft: Aircraft, statics: Any, constants: Any, inputs: Values) -> Values:
        """Margins and modes."""
        S, c, _ = arrays.reference(aircraft)
        slopes = LongitudinalDerivatives(**{n: inputs[n] for n in SLOPES}, CX_u=CX_U_OVER_CD * inputs["CD"])
        attitude = inputs["alpha"] * RAD
        flight = SteadyFlight(inputs["speed"], inputs["density"], attitude, attitude)
        body = {"mass": inputs["mass_cruise"], "I_yy": inputs["Iyy"], "S": S, "c": c}
        short = reduced_order(slopes, flight, CL=inputs["CL"], CD=inputs["CD"], **body)
        modes = longitudinal_modes(longitudinal_state_matrix(slopes, flight, **body))
        out = {n: getattr(short, n) for n in ("static_margin", "omega_sp", "zeta_sp", "omega_ph", "zeta_ph", "CAP")}
        for name, mode in (("sp", modes.short_period), ("ph", modes.phugoid)):
            out |= {f"omega_{name}_full": mode.omega, f"zeta_{name}_full": mode.zeta}
        return out | {"x_np": jnp.asarray(neutral_point(inputs["x_cg"], short.static_margin, c))}


def _complete(name: str, aircraft: Aircraft) -> None:
    """Reference quantities can be had."""
    given = aircraft.reference
    missing = [f"reference.{key}" for key in ("S_m2", "c_m") if getattr(given, key) is None]
    if aircraft.wing is None and missing:
        raise ValueError(f"{aircraft.name!r} has no stability: there is no wing, and no {' and no '.join(missing)}")
