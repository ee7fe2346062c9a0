"""What the aerodynamics of a whole aircraft takes: plain arrays, made from a definition by the components."""

from typing import NamedTuple

from jaxtyping import Array, Float

from hera_om.physics.blade_polar import Polar
from hera_om.physics.controls import Control
from hera_om.physics.fuselage import Fuselage
from hera_om.physics.geometry import CAMBER, Grid, Sections
from hera_om.physics.strip_polar import StripPolar, StripTable

Number = Float[Array, ""] | float


FAILURES = ("windmilling", "feathered", "stopped")
"""What a failed rotor does, see `disks.rotor_loads`."""


class Surface(NamedTuple):
    """One lifting surface of the starboard half."""

    sections: Sections
    grid: Grid
    polar: StripPolar | StripTable
    station: Float[Array, " k"]  # coordinate of the sections along the span, m
    controls: tuple[Control, ...] = ()
    thickness: Float[Array, " k"] | None = None  # of the sections over chord; absent: none


class Rotors(NamedTuple):
    """The m rotors of the starboard half (or one in the plane of symmetry), leading axis m."""

    hub: Float[Array, "m 3"]
    incidence: Float[Array, " m"]  # thrust tilted up, rad
    radius: Float[Array, " m"]
    hub_radius: Float[Array, " m"]
    nacelle_radius: Float[Array, " m"]  # 0 without one
    r: Float[Array, "m nt"]  # blade tables: radius and chord over the tip radius, twist relative to 75 % radius in rad
    chord: Float[Array, "m nt"]
    twist: Float[Array, "m nt"]
    polar: Polar  # fields [m, ...]: seven numbers, or tables of one shape
    blades: Float[Array, " m"]
    omega: Float[Array, " m"]  # rad/s
    sense: Float[Array, " m"]  # +1 or -1, see `rotor.sense_sign`


class Drag(NamedTuple):
    """Drag areas without lift: a of them, each at a place, some in the slipstream of a rotor."""

    area: Float[Array, " a"]  # m^2, all pieces together
    x: Float[Array, " a"]  # m
    z: Float[Array, " a"]  # m
    rotor_share: Float[Array, "a m"]  # shares of the area that stand behind each rotor; zero rows: in free stream


class Slender(NamedTuple):
    """A fuselage whose flow wing and tail feel, see `slender_body`."""

    shape: Fuselage
    root: tuple[Number, Number]  # leading and trailing edge of the wing root, m
    x_tail: Number  # station of the horizontal tail, or the end of the body, m


class Body(NamedTuple):
    """Reference quantities and what the lattice does not carry."""

    S: Number  # reference area, m^2
    c: Number  # reference chord, m
    b: Number  # reference span, m
    munk_slope: Number  # Cm by alpha of the fuselage, 1/rad
    drag: Drag


class Flow(NamedTuple):
    """The stream, and the point that moments and pitch rate refer to."""

    speed: Number  # m/s
    density: Number  # kg/m^3
    sound_speed: Number  # m/s
    viscosity: Number  # Pa s
    mach: Number  # of the Prandtl-Glauert rule
    point: Float[Array, " 3"]  # m


class Model(NamedTuple):
    """Static facts of the lattice: how surfaces are cut, meet the plane of symmetry, and answer to commands."""

    kinds: tuple[str, ...]  # of each surface, see `layout.layout`
    commands: int = 0  # how many the controls answer to
    shape: str = (
        CAMBER  # of the panels, see `geometry.surface_mesh`; FLAT follows AVL: bound filaments alone carry force
    )
    components: tuple[int, ...] | None = None  # of each surface, see `lattice.assemble`
    stream_wake: bool = False  # whether the wake runs along the free stream (without its sideslip), not along x
    lateral: bool = False  # whether the two halves may differ


class RotorPlan(NamedTuple):
    """Static facts of the rotors: discretisation, losses, failures."""

    groups: tuple[int, ...]  # group of each rotor: index into the pitch angles
    sides: int  # 2 for rotors on either side, 1 for one in the plane of symmetry
    radial: int
    azimuthal: int
    tip_loss: bool
    hub_loss: bool
    stall_delay: bool = False
    neighbours: bool = True  # whether a rotor feels the slipstreams of the others
    failed: tuple[tuple[int, int, str], ...] = ()  # half (0 starboard, 1 port), rotor, one of `FAILURES`
