"""The sized wing box as a component: two load cases in, mass and reserve factors out."""

from typing import Any

import jax.numpy as jnp
import numpy as np
import openmdao.api as om

from hera_om.aircraft.definition import Aircraft
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
)
from hera_om.physics.beam_loads import Loads, case_loads, point_load, strip_load
from hera_om.physics.wingbox import size_box
from hera_om.physics.wingbox_types import CRITERIA, PANELS, BoxGeometry, elastic_axis, stack_cases

PULL_UP, CRUISE = "pullup_", "cruise_"
CASES = (PULL_UP, CRUISE)
NOT_OUTPUT = ("mass", "cg", "active", "sizing_case", "section", "inertia", "stress")
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
    """Sizing under the limit loads of a pull-up (the mission's load factor) and of the cruise (factor 1).

    Loads of each case come from an `Aerodynamics` at its condition, under the prefixes ``pullup_`` and
    ``cruise_``. All rotors of the starboard side are taken to hang on the wing; what stands inboard of the
    fuselage joint does not load it. Relief: wing mass ``m_wing_relief`` (a group connects it to ``m_wing``),
    half the fuel items at their mass in the definition when there is a tank, and the items that track a rotor
    group.

    ``m_wing`` is primary structure / primary_fraction + remainder: the definition's ``mass_remainder_kg``,
    else the option ``remainder``, else none. It is frozen at the baseline: `frozen_remainder` gives the value
    for the option.
    """

    def initialize(self) -> None:
        """Declare the options."""
        super().initialize()
        self.options.declare("aircraft", types=Aircraft, check_valid=_complete, desc="definition of the aircraft")
        text = "mass beside primary / primary_fraction where the definition has no mass_remainder_kg [kg]"
        self.options.declare("remainder", 0.0, types=float, desc=text)

    def setup(self) -> None:
        """Read no more of the definition than the box depends on."""
        self.READS = box_reads(self.options["aircraft"])
        super().setup()

    def declare(self) -> None:
        """Loads of both cases in; mass, reserve factors and distributions out."""
        aircraft = self.options["aircraft"]
        weights = box_weights(aircraft)
        self.constants = (weights, box_tables(aircraft, weights), np.asarray(self.options["remainder"]))
        for name, (value, units, desc) in _load_inputs(aircraft).items():
            for prefix in CASES:
                self.add(prefix + name, val=value, units=units, desc=desc)
        total = aircraft.wing.structure.mass_total_baseline_kg
        self.add("m_wing_relief", val=total, units="kg", desc="mass of the wing whose weight relieves it")
        for name in ("m_wing", "RFC", "RFT"):
            self.add(name)
        self.add("RF_yield", desc="reserve factor of caps and stringers in yield at limit load, required 1")
        for part in PARTS:
            self.add(f"m_{part}", units="kg", desc=f"mass of the {part.replace('_', ' ')} of the sized box")
        self.add("m_primary", units="kg", desc="mass of the sized primary structure of the wing")
        self.add("m_remainder", units="kg", desc="frozen mass of the wing beside primary / primary_fraction")
        for name, (units, desc) in SPANWISE.items():
            self.add(name, shape=(aircraft.lattice.box_stations,), units=units, desc=desc)

    @staticmethod
    def evaluate(aircraft: Any, statics: Any, constants: Any, inputs: Values) -> Values:
        """Loads, sizing, mass; ``worst_excess`` and ``use`` are for the diagnosis alone."""
        weights, tables, remainder = constants
        structure, geometry = aircraft.wing.structure, box_geometry(aircraft, weights, tables)
        factors = (aircraft.mission.limit_load_factor, 1.0)
        loads = [_loads(aircraft, geometry, inputs, p, n) for p, n in zip(CASES, factors, strict=True)]
        box = size_box(
            geometry,
            box_material(aircraft),
            box_concept(aircraft),
            loads=stack_cases(*loads),
            A_cap_root=structure.A_cap_root_m2,
            A_stringer_root=structure.A_stringer_root_m2,
        )
        rest = remainder if structure.mass_remainder_kg is None else structure.mass_remainder_kg
        out = {name: value for name, value in box._asdict().items() if name not in NOT_OUTPUT}
        out |= {f"m_{part}": getattr(box.mass, part) for part in PARTS}
        out |= {"m_wing": box.m_primary / structure.primary_fraction + rest, "m_remainder": jnp.asarray(rest)}
        pull_up = dict(zip(("shear", "bending", "torsion"), loads[0][:3], strict=True))
        return out | pull_up | {"box_y": geometry.leading_edge[:, 1]}

    def store(self, out: Values, outputs) -> None:
        """Copy results, unless a station cannot carry its load at any thickness."""
        super().store(out, outputs)
        excess = np.asarray(out["worst_excess"])
        if np.max(excess) > UNCARRIED:
            station = int(np.argmax(excess))
            use = np.asarray(out["use"])[:, :, station]
            panel, criterion = np.unravel_index(np.argmax(use), use.shape)
            place = f"bay {station + 1} of {len(excess)} at y = {float(out['box_y'][station]):.2f} m"
            raise om.AnalysisError(
                f"{self.pathname}: {place}: no allowed thickness carries the load; "
                f"{PANELS[panel]}, {CRITERIA[criterion]}: utilisation {use[panel, criterion]:.3g}"
            )


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


def _loads(aircraft, geometry: BoxGeometry, inputs: Values, prefix: str, load_factor) -> Loads:
    """Section loads of one case at the stations."""
    point, force, moment = (inputs[f"{prefix}strip_{k}"] for k in ("point", "force", "moment"))
    none = jnp.zeros((0, 3))
    hub, thrust, torque = (inputs.get(f"{prefix}rotor_{k}", none) for k in ("hub", "force", "moment"))
    edges = inputs[f"{prefix}strip_edge"]
    return case_loads(
        geometry.leading_edge[:, 1],
        elastic_axis(geometry),
        aerodynamic=strip_load(edges, point, forces=force, moments=moment),
        rotors=point_load(hub, forces=thrust, moments=torque),
        masses=carried_masses(aircraft, edges, inputs["m_wing_relief"]),
        load_factor=load_factor,
    )
