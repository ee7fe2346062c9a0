"""Mass, balance and inertia: items that follow the design, and fuel by one of two rules."""

from typing import Any

import jax.numpy as jnp

from hera_om.aircraft.definition import Aircraft
from hera_om.aircraft.masses import Mass
from hera_om.aircraft.rotors import hub_ys
from hera_om.components.base import JaxComponent, Values
from hera_om.physics.mass_properties import mass_properties, pair_gyration

FIXED_MASS, FIXED_FUEL = "fixed_mass", "fixed_fuel"
STRUCTURE = ("wing", "htail", "vtail")  # what an item tracks when its mass is structural and sized
ROTOR = "rotor:"


class MassProperties(JaxComponent):
    """Mass of the aircraft, and its balance at the start of the cruise, the one loading that is looked at.

    Items follow what they track: ``wing`` has the mass ``m_wing``, ``htail`` and ``vtail`` go with the square
    of their scale from their mass at scale 1, ``rotor:<group>`` keeps its mass and spreads it over the
    group's hubs. Changes of all these from the masses of the definition are the mass saved. With
    ``fixed_mass`` it becomes fuel, so that the take-off mass stays; with ``fixed_fuel`` the take-off mass
    falls. The centre of gravity is in geometry axes and serves as the moment point of the aerodynamics.
    """

    def initialize(self) -> None:
        """Declare the options."""
        super().initialize()
        self.options.declare("aircraft", types=Aircraft, check_valid=_complete, desc="definition of the aircraft")
        rules = (FIXED_MASS, FIXED_FUEL)
        self.options.declare("fuel_rule", FIXED_MASS, values=rules, desc="what stays when the structure changes")

    def setup(self) -> None:
        """Read no more of the definition than this aircraft's items follow."""
        self.READS = _reads(self.options["aircraft"])
        super().setup()

    def declare(self) -> None:
        """Mass of the wing in, where an item tracks it; totals out."""
        aircraft, self.statics = self.options["aircraft"], self.options["fuel_rule"]
        if self.statics == FIXED_MASS and all(m.tracks != "fuel" for m in aircraft.mass):
            raise ValueError(
                f"{aircraft.name!r}: fuel_rule {FIXED_MASS!r} needs a [[mass]] item that tracks fuel; "
                f"{FIXED_FUEL!r} does not"
            )
        for item in aircraft.mass:
            if item.tracks == "wing":
                self.add("m_wing", val=item.m_kg)
        self.add("mass", units="kg", desc="take-off mass of the aircraft")
        for name in ("x_cg", "z_cg", "Ixx", "Iyy", "Izz", "Ixz"):
            self.add(name)
        self.add("mass_cruise", units="kg", desc="mass at the start of the cruise, climb fuel burnt")
        self.add("mass_fuel", units="kg", desc="fuel at take-off")
        self.add("mass_saved", units="kg", desc="structural mass below that of the definition")

    @staticmethod
    def evaluate(aircraft: Any, statics: str, constants: Any, inputs: Values) -> Values:
        """Totals at take-off, balance at the start of the cruise."""
        items, now = aircraft.mass, [_mass(aircraft, item, inputs) for item in aircraft.mass]
        saved = sum(i.m_kg - m for i, m in zip(items, now, strict=True) if i.tracks in STRUCTURE)
        gained = saved if statics == FIXED_MASS else 0.0
        burnt = aircraft.mission.climb_fuel_kg if aircraft.mission is not None else 0.0
        tanks = max(sum(i.tracks == "fuel" for i in items), 1)
        change = [(gained - burnt) / tanks if i.tracks == "fuel" else 0.0 for i in items]
        total = _assemble(aircraft, jnp.stack([jnp.asarray(m + d, float) for m, d in zip(now, change, strict=True)]))
        return {
            "mass": jnp.asarray(sum(now) + gained, float),
            "x_cg": total.cg[0],
            "z_cg": total.cg[2],
            "Ixx": total.I_xx,
            "Iyy": total.I_yy,
            "Izz": total.I_zz,
            "Ixz": total.I_xz,
            "mass_cruise": total.mass,
            "mass_fuel": jnp.asarray(sum(i.m_kg for i in items if i.tracks == "fuel") + gained, float),
            "mass_saved": jnp.asarray(saved, float),
        }


def _complete(name: str, aircraft: Aircraft) -> None:
    """There are masses."""
    if not aircraft.mass:
        raise ValueError(f"{aircraft.name!r} has no mass properties: there is no [[mass]] item")


def _reads(aircraft: Aircraft) -> tuple[str, ...]:
    """Paths that the items follow."""
    tracked = {m.tracks for m in aircraft.mass if m.tracks is not None}
    tails = [f"{t}.scale" for t in ("htail", "vtail") if t in tracked]
    groups = [t.removeprefix(ROTOR) for t in tracked if t.startswith(ROTOR)]
    hubs = [f"rotor.{g}.{key}" for g in groups for key in ("y_m", "spacing_m")]
    return ("mass", "mission.climb_fuel_kg", *tails, *hubs)


def _mass(aircraft: Aircraft, item: Mass, inputs: Values):
    """Mass of an item of this design; fuel as in the definition."""
    if item.tracks == "wing":
        return inputs["m_wing"]
    tail = {"htail": aircraft.htail, "vtail": aircraft.vtail}.get(item.tracks or "")
    return item.m_kg if tail is None else item.m_kg * tail.scale**2


def _spread(aircraft: Aircraft, item: Mass):
    """Root-mean-square spread of an item along y."""
    if item.tracks is None or not item.tracks.startswith(ROTOR):
        return item.ky_m
    group = next(r for r in aircraft.rotor if r.name == item.tracks.removeprefix(ROTOR))
    y = hub_ys(group)
    # One hub may stand at y = 0, where the square root has no derivative.
    return y[0] if len(y) == 1 else pair_gyration(jnp.stack([jnp.asarray(v, float) for v in y]))


def _assemble(aircraft: Aircraft, mass):
    """Mass properties of all items; a spread along z becomes two halves above and below the centre."""
    items = aircraft.mass
    position = [(i.x_m, i.y_m, i.z_m + side * i.kz_m) for side in (-1.0, 1.0) for i in items]
    gyration = [(i.kx_m, _spread(aircraft, i)) for i in items] * 2
    return mass_properties(jnp.concatenate([mass, mass]) / 2.0, _rows(position), _rows(gyration))


def _rows(table):
    """One array of numbers, traced or not."""
    return jnp.stack([jnp.stack([jnp.asarray(v, float) for v in row]) for row in table])
