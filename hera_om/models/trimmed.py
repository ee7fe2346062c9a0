"""Groups: a trimmed flight point, and the whole aircraft with its feedbacks closed."""

from typing import Literal

import numpy as np
import openmdao.api as om

from hera_om.aircraft.definition import Aircraft
from hera_om.aircraft.structure import WingStructure
from hera_om.components.aero import Aerodynamics
from hera_om.components.box_arrays import box_reads
from hera_om.components.mass import MassProperties
from hera_om.components.performance import Performance
from hera_om.components.stability import Stability
from hera_om.components.trim import Bounds, TrimBalance
from hera_om.components.wingbox import RIGID, WingBox
from hera_om.models.trim_solver import SURROGATE_TOLERANCE, TOLERANCE, TrimNewton
from hera_om.surrogates.surrogate_set import SurrogateSet

LOOP_TOLERANCE = 1e-6  # of the change in all outputs of a sweep, mostly strip loads in N: 1e-11 of them
SURROGATE_LOOP_TOLERANCE = 0.1  # the same for a surrogate, whose trim keeps to a looser tolerance: 1e-8 of them
MAX_SWEEPS = 40
LOAD_NAMES = ("strip_edge", "strip_point", "strip_force", "strip_moment")
ROTOR_NAMES = ("rotor_hub", "rotor_force", "rotor_moment")


Aero = Literal["lattice"] | SurrogateSet
"""What stands for the aerodynamics: the lattice, or a surrogate that replaces it."""


class TrimPoint(om.Group):
    """Aerodynamics and the balance that its states close, at one load factor."""

    def initialize(self) -> None:
        """Declare options."""
        self.options.declare("aircraft", types=Aircraft, desc="definition of the aircraft")
        self.options.declare("aero", default="lattice", desc="'lattice', or a SurrogateSet that replaces it")
        self.options.declare("powered", types=bool, default=True, desc="balance thrust too, by blade pitch")
        self.options.declare("load_factor", types=float, default=1.0, desc="load factor")

    def setup(self) -> None:
        """Two components and Newton's method."""
        aircraft = self.options["aircraft"]
        aero = aerodynamics(aircraft, self.options["aero"])
        within = known_box(self.options["aero"])
        self.balance = TrimBalance(aircraft=aircraft, powered=self.options["powered"], within=within)
        self.add_subsystem("aero", aero, promotes=["*"])
        self.add_subsystem("balance", self.balance, promotes=["*"])
        self.set_input_defaults("load_factor", val=self.options["load_factor"])
        tolerance = TOLERANCE if isinstance(self.options["aero"], str) else SURROGATE_TOLERANCE
        self.nonlinear_solver = TrimNewton(aero, self.balance, tolerance)
        self.linear_solver = om.DirectSolver()


def known_box(aero: Aero) -> Bounds:
    """Box of the inputs that a surrogate knows; the lattice has none."""
    if isinstance(aero, str):
        return {}
    return dict(zip(aero.input_names, zip(map(float, aero.lower), map(float, aero.upper), strict=True), strict=True))


def aerodynamics(aircraft: Aircraft, aero: Aero):
    """The lattice, or the surrogate that stands in for it."""
    if isinstance(aero, str):
        return Aerodynamics(aircraft=aircraft)
    from hera_om.components.surrogate import SurrogateAerodynamics

    return SurrogateAerodynamics(aircraft=aircraft, surrogate=aero)


class TrimmedAircraft(om.Group):
    """Mass properties, trimmed cruise, trimmed pull-up, wing box, stability and performance.

    The cruise's variables carry their registry names; the pull-up's stand under ``pullup``. In the pull-up the
    blade pitch stays as in the cruise and only lift and moment are balanced. The mass of the wing feeds back on
    balance and on the relief of its loads; the group's Gauss-Seidel iteration closes that loop.
    """

    def initialize(self) -> None:
        """Declare options."""
        self.options.declare("aircraft", types=Aircraft, desc="definition of the aircraft")
        self.options.declare("aero", default="lattice", desc="'lattice', or a SurrogateSet that replaces it")
        self.options.declare("remainder", types=float, default=0.0, desc="frozen part of the wing's mass, kg")
        self.options.declare("close_mass", types=bool, default=True, desc="feed the sized wing mass back")

    def setup(self) -> None:
        """Disciplines in the order of the data flow."""
        aircraft, aero = self.options["aircraft"], self.options["aero"]
        boxed = has_box(aircraft)
        self.add_subsystem("mass_properties", MassProperties(aircraft=aircraft), promotes=["*"])
        self._point("cruise", aero, mass="mass_cruise", powered=bool(aircraft.rotor), load_factor=1.0)
        if boxed:
            n = aircraft.mission.limit_load_factor
            self._point("pullup", aero, mass="mass", powered=False, load_factor=n)
            self._box(aircraft)
        self.add_subsystem("stability", Stability(aircraft=aircraft), promotes=["*"])
        if aircraft.mission is not None:
            self.add_subsystem("performance", Performance(aircraft=aircraft), promotes=["*"])
        tolerance = LOOP_TOLERANCE if isinstance(aero, str) else SURROGATE_LOOP_TOLERANCE
        self.nonlinear_solver = om.NonlinearBlockGS(
            maxiter=MAX_SWEEPS,
            atol=tolerance,
            rtol=1e-99,
            iprint=-1,
            use_aitken=True,
            err_on_non_converge=True,
        )
        self.linear_solver = om.DirectSolver()

    def _point(self, name: str, aero, *, mass: str, powered: bool, load_factor: float) -> None:
        """A trim point; only the cruise's outputs are promoted."""
        aircraft = self.options["aircraft"]
        point = TrimPoint(aircraft=aircraft, aero=aero, powered=powered, load_factor=load_factor)
        shared = ["mach", "altitude", "x_cg", "z_cg", "q_hat", *aero_variables(aircraft)]
        if not powered:
            shared += [f"theta_{r.name}" for r in aircraft.rotor]
        promotes = [*shared, ("mass", mass)]
        outputs = ["*"] if name == "cruise" else None
        self.add_subsystem(name, point, promotes_inputs=promotes, promotes_outputs=outputs)

    def _box(self, aircraft: Aircraft) -> None:
        """The wing box between the two trim points and the mass properties."""
        box = WingBox(aircraft=aircraft, remainder=self.options["remainder"])
        inputs = box_variables(aircraft)
        closed = self.options["close_mass"]
        outputs = ["*"] if closed else ["m_primary", "RFC", "RFT"]
        inputs += ["mass", "mass_cruise", "CZ_alpha", "speed"]
        # OpenMDAO hands a component its own output only in derivatives: the feedback goes through a copy.
        kg = {"units": "kg", "val": wing_structure(aircraft).mass_total_baseline_kg}
        copy = om.ExecComp("m_wing_relief = m_wing", m_wing=kg, m_wing_relief=kg)
        self.add_subsystem("relief", copy, promotes=["*"])
        if wing_structure(aircraft).aeroelastic:
            self._stiffness(aircraft)
        self.add_subsystem("wing_box", box, promotes_inputs=[*inputs, "m_wing_relief"], promotes_outputs=outputs)
        for name in (*LOAD_NAMES, *(ROTOR_NAMES if aircraft.rotor else ())):
            self.connect(name, f"wing_box.cruise_{name}")
            self.connect(f"pullup.{name}", f"wing_box.pullup_{name}")

    def _stiffness(self, aircraft: Aircraft) -> None:
        """Stiffness of the sized wing fed back to its loads, and the lattice's lift by twist."""
        if not isinstance(self.options["aero"], str):
            raise ValueError(f"{aircraft.name!r}: wing.structure.aeroelastic needs the lattice, not a surrogate")
        rigid = {"units": "MN*m**2", "val": np.full(aircraft.lattice.box_stations, RIGID)}
        values = {name: rigid for name in ("EI", "GJ", "EI_flying", "GJ_flying")}
        copy = om.ExecComp(["EI_flying = EI", "GJ_flying = GJ"], has_diag_partials=True, **values)
        self.add_subsystem("stiffness", copy)
        for name in ("EI", "GJ"):
            self.connect(f"wing_box.{name}" if not self.options["close_mass"] else name, f"stiffness.{name}")
            self.connect(f"stiffness.{name}_flying", f"wing_box.{name}_flying")
        self.connect("strip_lift_by_twist", "wing_box.strip_lift_by_twist")


def has_box(aircraft: Aircraft) -> bool:
    """Whether the wing is sized."""
    return aircraft.wing is not None and aircraft.wing.structure is not None and aircraft.mission is not None


def wing_structure(aircraft: Aircraft) -> WingStructure:
    """The wing box of an aircraft that has one."""
    assert aircraft.wing is not None and aircraft.wing.structure is not None
    return aircraft.wing.structure


def _read(aircraft: Aircraft, reads: tuple[str, ...]) -> list[str]:
    """Design variables under some paths."""
    return [v.name for v in aircraft.variables if any(v.path == r or v.path.startswith(r + ".") for r in reads)]


def aero_variables(aircraft: Aircraft) -> list[str]:
    """Design variables of the aerodynamics."""
    return _read(aircraft, Aerodynamics.READS)


def box_variables(aircraft: Aircraft) -> list[str]:
    """Design variables of the wing box."""
    return _read(aircraft, box_reads(aircraft))
