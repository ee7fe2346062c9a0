"""The aircraft: the one typed, immutable model that ties every part of a definition together."""

from pydantic import Field

from hera_om.aircraft.airfoils import Airfoil
from hera_om.aircraft.body import DragArea, Fuselage
from hera_om.aircraft.fields import Part, item
from hera_om.aircraft.free_surfaces import Surface
from hera_om.aircraft.masses import Mass
from hera_om.aircraft.mission import Flight, Lattice, Mission, Reference, Variable
from hera_om.aircraft.rotors import Blade, Rotor
from hera_om.aircraft.structure import Laminate, Material
from hera_om.aircraft.surfaces import HTail, VTail, Wing


class Aircraft(Part):
    """What an aircraft is. Every table but [flight] may be absent."""

    name: str = Field(description="name of the aircraft", min_length=1)
    source: str = item("where the numbers come from", "")
    reference: Reference = item("reference quantities", Reference())
    flight: Flight = item("flight condition")
    mission: Mission | None = item("mission", None)
    wing: Wing | None = item("wing", None)
    htail: HTail | None = item("horizontal tail", None)
    vtail: VTail | None = item("vertical tail", None)
    surface: tuple[Surface, ...] = item("further lifting surfaces", ())
    airfoil: tuple[Airfoil, ...] = item("airfoils by coordinates; those of .dat files are copied in when loading", ())
    fuselage: Fuselage | None = item("fuselage", None)
    drag_area: tuple[DragArea, ...] = item("drag areas", ())
    rotor: tuple[Rotor, ...] = item("rotor groups", ())
    blade: tuple[Blade, ...] = item("blades", ())
    mass: tuple[Mass, ...] = item("mass items", ())
    material: tuple[Material, ...] = item("materials; a shipped one that is used is copied in when loading", ())
    laminate: tuple[Laminate, ...] = item("laminates; a shipped one that is used is copied in when loading", ())
    variables: tuple[Variable, ...] = item("design variables", ())
    lattice: Lattice = item("density of the discretisation", Lattice())

    def blade_of(self, rotor: Rotor) -> Blade:
        """The blade of a rotor group."""
        return next(b for b in self.blade if b.name == rotor.blade)

    def wing_material(self) -> Material | Laminate:
        """The material or laminate of the wing box; the wing must have a structure."""
        if self.wing is None or self.wing.structure is None:
            raise ValueError(f"{self.name} has no wing structure")
        wanted = self.wing.structure.material
        return next(m for m in (*self.material, *self.laminate) if m.name == wanted)
