"""The sized wing box as a component: two trimmed cases in, all load cases, mass and reserve factors out."""

from typing import Any

import jax.numpy as jnp
import numpy as np
import openmdao.api as om

from hera_om.aircraft.definition import Aircraft
from hera_om.aircraft.rotors import hub_ys
from hera_om.aircraft.structure import Laminate
from hera_om.components import arrays
from hera_om.components.base import JaxComponent, Values
from hera_om.components.box_arrays import (
    box_concept,
    box_geometry,
    box_material,
    box_reads,
    box_tables,
    box_weights,
    carried_masses,
    fuel_mass,
    rotor_spins,
)
from hera_om.physics.aeroelastic import (
    FlexibleWing,
    at_constant_lift,
    divergence_ratio,
    elastic_loads,
    flexibility,
)
from hera_om.physics.beam import BeamProperties, deflection, first_of_each
from hera_om.physics.beam_loads import (
    Loads,
    SpanLoad,
    SpanMass,
    inertia_load,
    point_load,
    section_loads,
    strip_load,
)
from hera_om.physics.bird_strike import leading_edge
from hera_om.physics.load_cases import CASES, CaseWeights, case_matrix, gyroscopic_moment
from hera_om.physics.wingbox import box_model, evaluate_box, solve_thickness
from hera_om.physics.wingbox_beam import wing_beam
from hera_om.physics.wingbox_bought import bought_box
from hera_om.physics.wingbox_types import CRITERIA, PANELS, BoxGeometry, BoxLoads, box_centre, elastic_axis

TRIMMED = ("pullup_", "cruise_")
RIGID = 1e9  # MN m2: stiffness of the first sweep, before the box is sized
UNCARRIED = 1e-6  # excess of the utilisation above which a station counts as not carrying its load
PARTS = ("skins", "webs", "caps", "stringers", "ribs", "centre_section")
SPANWISE = {
    "RFC_span": (None, "reserve factor of caps and stringers in compression by station"),
    "RFT_span": (None, "reserve factor of caps and stringers in tension by station"),
    "t_skin_upper": ("m", "thickness of the upper skin by station"),
    "t_skin_lower": ("m", "thickness of the lower skin by station"),
    "t_web_front": ("m", "thickness of the front web by station"),
    "t_web_rear": ("m", "thickness of the rear web by station"),
    "t_rib": ("m", "thickness of a rib by station"),
    "box_y": ("m", "y of the stations, from the joint to the tip"),
    "shear": ("N", "limit shear in the pull-up by station, up positive"),
    "bending": ("N*m", "limit bending moment in the pull-up by station, tip up positive"),
    "torsion": ("N*m", "limit torque in the pull-up by station about 35 % of the chord, nose up positive"),
}


class WingBox(JaxComponent):
    """Sizing under the limit loads of `load_cases.CASES`, and the reserve of caps and stringers.

    Air loads come from two `Aerodynamics`, under the prefixes ``pullup_`` (at the mission's load factor and the
    take-off mass) and ``cruise_`` (factor 1, ``mass_cruise``); every case is a mixture of the two by its lift. All
    rotors of the starboard side are taken to hang on the wing; what stands inboard of the fuselage joint does not
    load it. Relief: wing mass ``m_wing_relief`` (a group connects it to ``m_wing``), half the fuel items at their
    mass in the definition when there is a tank, and the items that track a rotor group.

    ``m_wing`` is primary structure / primary_fraction + remainder: the definition's ``mass_remainder_kg``,
    else the option ``remainder``, else none. It is frozen at the baseline: `frozen_remainder` gives the value
    for the option. ``m_wing_rounded`` is the same with the sheets that can be bought.

    ``last`` holds everything of the last evaluation by name, for pictures and diagnosis.
    """

    PIECEWISE = ("sizing_case", "sizing_criterion", "m_wing_rounded", "RFC_rounded", "RFT_rounded")

    def initialize(self) -> None:
        """Declare the options."""
        super().initialize()
        self.options.declare("aircraft", types=Aircraft, check_valid=_complete, desc="definition of the aircraft")
        text = "mass beside primary / primary_fraction where the definition has no mass_remainder_kg [kg]"
        self.options.declare("remainder", 0.0, types=float, desc=text)
        self.last: Values = {}

    def setup(self) -> None:
        """Read no more of the definition than the box depends on."""
        self.READS = box_reads(self.options["aircraft"])
        super().setup()

    def declare(self) -> None:
        """Loads of both trimmed cases in; mass, reserve factors and distributions out."""
        aircraft = self.options["aircraft"]
        weights = box_weights(aircraft)
        self.criteria = ("Tsai-Wu", *CRITERIA[1:]) if isinstance(aircraft.wing_material(), Laminate) else CRITERIA
        self.constants = (weights, box_tables(aircraft, weights), np.asarray(self.options["remainder"]))
        self.statics = _outer_rotor(aircraft)
        for name, (value, units, desc) in _load_inputs(aircraft).items():
            for prefix in TRIMMED:
                self.add(prefix + name, val=value, units=units, desc=desc)
        total = aircraft.wing.structure.mass_total_baseline_kg
        self.add("m_wing_relief", val=total, units="kg", desc="mass of the wing whose weight relieves it")
        mass = max(sum(item.m_kg for item in aircraft.mass), total)
        self.add("mass", val=mass, units="kg", desc="take-off mass, of the pull-up")
        self.add("mass_cruise", val=mass, units="kg", desc="mass in the trimmed cruise")
        self.add("CZ_alpha", val=6.0, units="1/rad", desc="slope of lift of the aircraft, for gusts")
        self.add("speed", val=150.0, units="m/s", desc="true airspeed of the trimmed cases")
        self._declare_results(aircraft.lattice.box_stations)
        if aircraft.wing.structure.aeroelastic:
            self._declare_stiffness(aircraft.lattice.box_stations)

    def _declare_stiffness(self, stations: int) -> None:
        """Stiffness out, and in again: a group connects the two, as it does the mass."""
        strips = len(self._var_rel2meta["cruise_strip_edge"]["val"]) - 1
        text = "lift of each strip of the wing (rows) by the incidence of each"
        self.add("strip_lift_by_twist", val=np.zeros((strips, strips)), units="N/rad", desc=text)
        for name, text in (("EI", "in bending up"), ("GJ", "in torsion")):
            self.add(name, shape=(stations,), units="MN*m**2", desc=f"stiffness {text} by station")
            rigid = np.full(stations, RIGID)
            self.add(f"{name}_flying", val=rigid, units="MN*m**2", desc=f"stiffness {text} of the wing that is loaded")

    def _declare_results(self, stations: int) -> None:
        """Outputs."""
        for name in ("m_wing", "RFC", "RFT"):
            self.add(name)
        self.add("RF_yield", desc="reserve factor of caps and stringers in yield at limit load, required 1")
        for part in PARTS:
            self.add(f"m_{part}", units="kg", desc=f"mass of the {part.replace('_', ' ')} of the sized box")
        self.add("m_primary", units="kg", desc="mass of the sized primary structure of the wing")
        self.add("m_secondary", units="kg", desc="mass that goes with the primary structure, by primary_fraction")
        self.add("m_leading_edge", units="kg", desc="part of m_secondary: skin ahead of the front spar, by bird strike")
        self.add("m_remainder", units="kg", desc="frozen mass of the wing beside primary / primary_fraction")
        self.add("m_wing_rounded", units="kg", desc="mass of the wing with thicknesses that can be bought")
        self.add("RFC_rounded", desc="RFC with thicknesses that can be bought")
        self.add("RFT_rounded", desc="RFT with thicknesses that can be bought")
        for name, text in (("w_tip", "deflection"), ("twist_tip", "twist nose-up")):
            units = "m" if name == "w_tip" else "rad"
            self.add(name, units=units, desc=f"{text} of the tip in the pull-up, from the joint, limit load")
        for name in ("bending", "torsion"):
            self.add(f"omega_{name}", units="rad/s", desc=f"first frequency of the full wing, mostly {name}")
        for name, (units, desc) in SPANWISE.items():
            self.add(name, shape=(stations,), units=units, desc=desc)
        panels = f"of {', '.join(PANELS)} (rows) by station"
        self.add("sizing_case", shape=(4, stations), desc=f"number of the sizing case {panels}; {', '.join(CASES)}")
        self.add("sizing_criterion", shape=(4, stations), desc=f"what sizes {panels}: {', '.join(self.criteria)}")

    @staticmethod
    def evaluate(aircraft: Any, statics: Any, constants: Any, inputs: Values) -> Values:
        """Loads, sizing, mass; what is no declared output is for pictures and the diagnosis alone."""
        weights, tables, remainder = constants
        structure, geometry = aircraft.wing.structure, box_geometry(aircraft, weights, tables)
        unit = _unit_loads(aircraft, geometry, inputs, statics)
        matrix = _case_matrix(aircraft, inputs)
        cases, turning = Loads(*(matrix @ jnp.stack(v) for v in zip(*unit, strict=True))), jnp.zeros((1, 1))
        if structure.aeroelastic:
            cases, turning = _with_elastic_loads(geometry, inputs, unit, matrix, cases)
        concept, material = box_concept(aircraft), box_material(aircraft)
        areas = {"A_cap_root": structure.A_cap_root_m2, "A_stringer_root": structure.A_stringer_root_m2}
        model = box_model(geometry, material, concept, loads=BoxLoads(**cases._asdict()), **areas)
        centre = box_centre(geometry, concept)
        box = evaluate_box(model, centre, solve_thickness(model))
        bought = bought_box(model, centre, box, increment=structure.t_increment_m, max_step=structure.t_step_max_m)
        edge = leading_edge(geometry, material, concept, speed=aircraft.mission.V_C_EAS_m_s)
        rest = remainder if structure.mass_remainder_kg is None else structure.mass_remainder_kg
        share = structure.primary_fraction
        out = {name: value for name, value in box._asdict().items() if name != "mass"}
        out |= {f"m_{part}": getattr(box.mass, part) for part in PARTS}
        out |= {"m_wing": box.m_primary / share + rest, "m_remainder": jnp.asarray(rest)}
        out |= {"m_secondary": box.m_primary * (1.0 / share - 1.0), "m_leading_edge": edge.mass}
        out |= {"m_wing_rounded": bought.m_primary / share + rest, "bought": bought, "leading_edge": edge}
        out |= {"RFC_rounded": bought.RFC, "RFT_rounded": bought.RFT}
        out |= dict(zip(("shear", "bending", "torsion"), (v[0] for v in cases[:3]), strict=True))
        out |= {"sizing_case": box.sizing_case.astype(float), "sizing_criterion": box.active.astype(float)}
        weight = Loads(*(jnp.sum(jnp.stack(parts), axis=0) for parts in zip(*unit[3:6], strict=True)))
        beam = wing_beam(geometry, material, box.section, weight)
        bent = deflection(beam, shear=cases.V[0], bending=cases.M[0], torque=cases.T[0])
        out |= {"w_tip": bent.w[-1], "twist_tip": bent.twist[-1], "bent": bent, "turning": turning}
        out |= {"EI": 1e-6 * beam.EI, "GJ": 1e-6 * beam.GJ}
        out |= dict(zip(("omega_bending", "omega_torsion"), first_of_each(beam), strict=True))
        return out | {"box_y": geometry.leading_edge[:, 1], "case_loads": cases, "unit_loads": unit}

    def store(self, out: Values, outputs) -> None:
        """Copy results, unless a station cannot carry its load at any thickness."""
        self.last = out
        super().store(out, outputs)
        ratio = divergence_ratio(np.asarray(out["turning"]))
        if ratio < 1.0:
            text = f"the wing diverges at {ratio:.3g} of the dynamic pressure of its loads"
            raise om.AnalysisError(f"{self.pathname}: {text}; its torsional stiffness is too low")
        excess = np.asarray(out["worst_excess"])
        if np.max(excess) > UNCARRIED:
            station = int(np.argmax(excess))
            use = np.asarray(out["use"])[:, :, station]
            panel, criterion = np.unravel_index(np.argmax(use), use.shape)
            case = CASES[int(out["sizing_case"][panel, station])]
            place = f"bay {station + 1} of {len(excess)} at y = {float(out['box_y'][station]):.2f} m"
            raise om.AnalysisError(
                f"{self.pathname}: {place}: no allowed thickness carries the load; "
                f"{PANELS[panel]}, {self.criteria[criterion]} in {case}: utilisation {use[panel, criterion]:.3g}"
            )


def _with_elastic_loads(geometry: BoxGeometry, inputs: Values, unit: list[Loads], matrix, cases: Loads):
    """Cases with what bending and twist add, over the shape of the wing in the cruise; and S G without trim.

    Who does not fly is not turned: a case's share of the air loads is one or, on the ground, none.
    """
    axis, nothing = elastic_axis(geometry), jnp.zeros(geometry.chord.shape)
    step = jnp.linalg.norm(jnp.diff(axis, axis=0), axis=1)
    s = jnp.concatenate([jnp.zeros(1), jnp.cumsum(step)])
    EI, GJ = (1e6 * inputs[f"{name}_flying"] for name in ("EI", "GJ"))
    beam = BeamProperties(s, EI, GJ, nothing, nothing, nothing)
    wing = FlexibleWing(beam, axis, inputs["cruise_strip_edge"], inputs["cruise_strip_point"])
    slope = inputs["strip_lift_by_twist"]
    cruise = Loads(*(unit[0][i] + sum(unit[k][i] for k in (3, 4, 5)) for i in range(len(Loads._fields))))
    more = elastic_loads(wing, at_constant_lift(slope), cases, cruise)
    flown = (matrix[:, 0] + matrix[:, 1])[:, None]
    return Loads(*(c + flown * m for c, m in zip(cases, more, strict=True))), slope @ flexibility(wing)


def frozen_remainder(aircraft, m_primary: float) -> float:
    """Remainder that gives the baseline its total: mass_total_baseline_kg - m_primary / primary_fraction, kg.

    Args:
        aircraft: definition of the baseline.
        m_primary: sized primary structure of the baseline, kg.
    """
    structure = aircraft.wing.structure
    return structure.mass_total_baseline_kg - m_primary / structure.primary_fraction


def _complete(name: str, aircraft: Aircraft) -> None:
    """Wing, box, material and mission are there."""
    parts = {
        "wing": aircraft.wing,
        "wing.structure": aircraft.wing and aircraft.wing.structure,
        "mission": aircraft.mission,
    }
    missing = [f"[{part}]" for part, value in parts.items() if value is None]
    if missing:
        raise ValueError(f"{aircraft.name!r} has no wing box: there is no {' and no '.join(missing)}")


def _load_inputs(aircraft) -> dict[str, tuple[Any, str, str]]:
    """Value, unit and meaning of the load inputs of one case: strips and rotors without load."""
    s = arrays.wing_arrays(aircraft)
    edges = arrays.grids(aircraft)[0].weights @ np.asarray(s.y)
    y = 0.5 * (edges[1:] + edges[:-1])
    points = np.stack([np.interp(y, s.y, v) for v in (s.x_le + 0.25 * s.chord, s.y, s.z)], axis=1)
    none = np.zeros((len(y), 3))
    found = {
        "strip_edge": (edges, "m", "y of the edges of the wing's strips"),
        "strip_point": (points, "m", "where the strips' forces act"),
        "strip_force": (none, "N", "force on each strip of the starboard wing, geometry axes"),
        "strip_moment": (none, "N*m", "moment on each strip about its point, geometry axes"),
    }
    rotors = arrays.rotors(aircraft)
    if rotors is not None:
        still = np.zeros(rotors.hub.shape)
        found["rotor_hub"] = (rotors.hub, "m", "hubs of the starboard rotors")
        found["rotor_force"] = (still, "N", "force of each starboard rotor, geometry axes")
        found["rotor_moment"] = (still, "N*m", "moment of each starboard rotor about its hub, geometry axes")
    return found


def _outer_rotor(aircraft) -> int:
    """Place of the rotor farthest outboard among the starboard rotors."""
    hubs = [float(y) for group in aircraft.rotor for y in hub_ys(group)]
    return int(np.argmax(hubs)) if hubs else 0


def _unit_loads(aircraft, geometry: BoxGeometry, inputs: Values, outer: int) -> list[Loads]:
    """Section loads of each of `load_cases.UNIT_LOADS`."""
    y, axis = geometry.leading_edge[:, 1], elastic_axis(geometry)
    carried = carried_masses(aircraft, inputs["cruise_strip_edge"], inputs["m_wing_relief"])
    nothing = point_load(jnp.zeros((1, 3)), forces=jnp.zeros((1, 3)), moments=jnp.zeros((1, 3)))

    def air(prefix: str) -> Loads:
        point, force, moment = (inputs[f"{prefix}strip_{k}"] for k in ("point", "force", "moment"))
        return section_loads(
            y, axis, strip_load(inputs[f"{prefix}strip_edge"], point, forces=force, moments=moment), *hubs(prefix)
        )

    def hubs(prefix: str) -> list[SpanLoad]:
        if not aircraft.rotor:
            return []
        hub, force, moment = (inputs[f"{prefix}rotor_{k}"] for k in ("hub", "force", "moment"))
        return [point_load(hub, forces=force, moments=moment)]

    def weight(*masses: SpanMass) -> Loads:
        return section_loads(y, axis, nothing, *(inertia_load(m, 1.0) for m in masses))

    failed = turning = nothing
    if aircraft.rotor:
        (every,) = hubs("cruise_")
        failed = SpanLoad(*(v[outer : outer + 1] for v in every))
        moment = gyroscopic_moment(*rotor_spins(aircraft), jnp.array([0.0, 1.0, 0.0]))
        turning = point_load(inputs["cruise_rotor_hub"], forces=0.0 * moment, moments=moment)
    masses = [weight(carried.structure), weight(*carried.fuel), weight(*carried.motors)]
    return [air("cruise_"), air("pullup_"), section_loads(y, axis, failed), *masses, section_loads(y, axis, turning)]


def _case_matrix(aircraft, inputs: Values):
    """Coefficients of the unit loads in each case."""
    mission = aircraft.mission
    landing = inputs["mass"] if mission.landing_mass_kg is None else mission.landing_mass_kg
    area, chord, _ = arrays.reference(aircraft)
    return case_matrix(
        CaseWeights(inputs["mass"], inputs["mass_cruise"], fuel_mass(aircraft), landing),
        limit_factor=mission.limit_load_factor,
        lift_slope=inputs["CZ_alpha"],
        area=area,
        chord=chord,
        altitude=aircraft.flight.altitude_m,
        V_C=mission.V_C_EAS_m_s,
        ceiling=mission.ceiling_m,
        speed=inputs["speed"],
        stroke=mission.gear_stroke_m,
    )
