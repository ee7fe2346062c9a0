"""Cruise range by Eq. 6 with both ways to spend saved mass, and range per shaft energy."""

from typing import Any

from hera_om.aircraft.definition import Aircraft
from hera_om.components.base import JaxComponent, Values
from hera_om.components.mass import FIXED_FUEL, FIXED_MASS
from hera_om.physics.performance import cruise_range

KILOMETRE = 1e3  # m


class Performance(JaxComponent):
    """Range at fixed take-off mass and at fixed fuel; with rotors, range per shaft energy too.

    ``fuel_rule`` is that of the component that gives ``mass``: it says whether this take-off mass still holds
    the mass saved, as fuel, or lacks it. Both ranges are given either way.
    """

    READS = ("mission.climb_fuel_kg", "mission.cruise_fuel_kg", "mission.c_s_1_per_s")

    def initialize(self) -> None:
        """Declare the options."""
        super().initialize()
        self.options.declare("aircraft", types=Aircraft, check_valid=_complete, desc="definition of the aircraft")
        rules = (FIXED_MASS, FIXED_FUEL)
        self.options.declare("fuel_rule", FIXED_MASS, values=rules, desc="rule behind the input mass")

    def declare(self) -> None:
        """Cruise state and masses in, ranges out."""
        self.statics = self.options["fuel_rule"]
        self.add("speed", val=150.0, units="m/s", desc="true airspeed")
        self.add("L_over_D", val=15.0)
        self.add("mass", val=2e4, units="kg", desc="take-off mass of the aircraft")
        self.add("mass_saved", val=0.0, units="kg", desc="structural mass below that of the definition")
        self.add("range_fixed_mass")
        self.add("range_fixed_fuel")
        if self.options["aircraft"].rotor:
            self.add("power", val=2e6)
            self.add("range_per_energy")

    @staticmethod
    def evaluate(aircraft: Any, statics: str, constants: Any, inputs: Values) -> Values:
        """Ranges."""
        mission, saved = aircraft.mission, inputs["mass_saved"]
        baseline = inputs["mass"] + (saved if statics == FIXED_FUEL else 0.0)
        found = cruise_range(
            inputs["speed"],
            inputs["L_over_D"],
            mission.c_s_1_per_s,
            takeoff_mass=baseline,
            climb_fuel=mission.climb_fuel_kg,
            cruise_fuel=mission.cruise_fuel_kg,
            mass_saved=saved,
            shaft_power=inputs.get("power", 1.0),
        )
        return {
            "range_fixed_mass": found.range_fixed_takeoff / KILOMETRE,
            "range_fixed_fuel": found.range_fixed_fuel / KILOMETRE,
            "range_per_energy": found.range_per_shaft_energy,
        }


def _complete(name: str, aircraft: Aircraft) -> None:
    """There is a mission."""
    if aircraft.mission is None:
        raise ValueError(f"{aircraft.name!r} has no range: there is no [mission]")
