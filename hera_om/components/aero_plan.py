"""What the aerodynamics of an aircraft consists of: hashable statics, names and shapes of the outputs, their texts."""

from typing import Any

from hera_om.aircraft.lifting_surfaces import lifting_surfaces
from hera_om.components import arrays
from hera_om.physics.layout import SINGLE

COEFFICIENTS = ("CL", "CD", "CX", "CZ", "Cm")
LATERAL = ("CY", "Cl", "Cn")
PARTS, PARTS_BY = "parts", "parts_by"
"""Endings of outputs: a coefficient of each part, and its derivatives by the columns."""
FUSELAGE, ROTORS = "fuselage", "rotors"
"""Names of the parts that are no lifting surface, see `physics.aerodynamics.Shares`."""


class AeroPlan:
    """Hashable statics of the aerodynamics of an aircraft."""

    def __init__(self, aircraft, lateral: bool = False) -> None:
        self.rotors = arrays.plan(aircraft, lateral)
        self.groups = tuple(r.name for r in aircraft.rotor)
        self.commands = arrays.model_commands(aircraft, lateral)
        self.model = arrays.model(aircraft, lateral)
        surfaces = (s.name for s in arrays.parts(aircraft, lateral))
        box = None if aircraft.wing is None else aircraft.wing.structure
        self.aeroelastic = box is not None and box.aeroelastic and not lateral
        self.parts = (*surfaces, FUSELAGE, *((ROTORS,) if self.groups else ()))

    def _key(self):
        return self.rotors, self.groups, self.commands, self.model, self.parts, self.aeroelastic

    def __hash__(self) -> int:
        """Hash of the statics."""
        return hash(self._key())

    def __eq__(self, other: object) -> bool:
        """Equal statics."""
        return isinstance(other, AeroPlan) and self._key() == other._key()

    def __repr__(self) -> str:
        """All of the statics, see `core.programs`."""
        return f"AeroPlan{self._key()}"

    def outputs(self, aircraft) -> dict[str, tuple[int, ...]]:
        """Names and shapes of the outputs."""
        scalars = [
            *COEFFICIENTS,
            "L_over_D",
            "CDi",
            "CDi_near",
            "CD_slipstream",
            "CD_profile",
            "CD_fuselage",
            "CD_areas",
        ]
        if self.model.kinds:
            scalars += ["lift_margin", "lift_margin_smooth"]
            scalars += ["stall_surface", "stall_y"] if self.model.lateral else []
        scalars += ["dynamic_pressure", "q_S", "speed", "density", "coupling_residual"]
        scalars += LATERAL if self.model.lateral else ()
        scalars += [f"{c}_{by}" for c in self.coefficients for by in self.by]
        out: dict[str, tuple[int, ...]] = {name: (1,) for name in scalars}
        p, n = len(self.parts), len(self.columns)
        out |= {f"{c}_{PARTS}": (p,) for c in self.split} | {f"{c}_{PARTS_BY}": (p, n) for c in self.split}
        if self.groups:
            out |= {name: (1,) for name in ("thrust", "power")}
            families = ("thrust", "power", "CT", "CP", "eta")
            out |= {f"{f}_{g}": (1,) for g in self.groups for f in families}
            m = sum(len(self.members(i)) for i in range(len(self.groups)))
            out |= {"rotor_hub": (m, 3), "rotor_force": (m, 3), "rotor_moment": (m, 3)}
        if aircraft.wing is not None:
            ns = lifting_surfaces(aircraft)[0].spanwise
            out |= {"cl_span": (ns,), "y_span": (ns,), "strip_edge": (ns + 1,), "strip_point": (ns, 3)}
            out |= {"strip_force": (ns, 3), "strip_moment": (ns, 3)}
            out |= {"strip_lift_by_twist": (ns, ns)} if self.aeroelastic else {}
        return out

    def members(self, group: int) -> list[int]:
        """Indices of the rotors of a group."""
        return [] if self.rotors is None else [k for k, g in enumerate(self.rotors.groups) if g == group]

    def running(self, group: int, halves: int) -> list[int]:
        """Indices of the rotors of a group that have not failed, halves one after the other."""
        gone = () if self.rotors is None else [(half, k) for half, k, _ in self.rotors.failed]
        count = 0 if self.rotors is None else len(self.rotors.groups)
        return [h * count + k for h in range(halves) for k in self.members(group) if (h, k) not in gone]

    @property
    def coefficients(self) -> tuple[str, ...]:
        """The coefficients of the model."""
        return COEFFICIENTS + LATERAL if self.model.lateral else COEFFICIENTS

    @property
    def split(self) -> tuple[str, ...]:
        """The coefficients that are given by part: single conditions alone, optimisations have no use for them."""
        return tuple(c for c in self.coefficients if c not in ("CL", "CD")) if self.model.lateral else ()

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the state, in the order of `aerodynamics.AeroResult`: rates without their hats."""
        slip = ("beta", "p", "r") if self.model.lateral else ()
        return ("alpha", "q", *self.commands, *(f"theta_{g}" for g in self.groups), *slip)

    @property
    def by(self) -> tuple[str, ...]:
        """What coefficients are differentiated by; by alpha-dot and beta-dot where all surfaces have their image."""
        rates = ("alphadot", "betadot") if self.model.lateral else ("alphadot",)
        return self.columns if SINGLE in self.model.kinds else (*self.columns, *rates)


TEXTS: dict[str, dict[str, Any]] = {
    **{f"{c}_{PARTS}": {"desc": f"{c} of each part, see `AeroPlan.parts`"} for c in (*COEFFICIENTS, *LATERAL)},
    **{
        f"{c}_{PARTS_BY}": {"desc": f"derivatives of {c} of each part by `AeroPlan.columns`"}
        for c in (*COEFFICIENTS, *LATERAL)
    },
    "lift_margin": {"desc": "least of cl_max - |cl| over all strips; negative: stalled, the model does not hold"},
    "lift_margin_smooth": {"desc": "smooth minimum of the same, never above it: for constraints"},
    "stall_surface": {"desc": "index of the lifting surface with the least margin, the wing being 0"},
    "stall_y": {"units": "m", "desc": "where on it that strip stands"},
    "coupling_residual": {"desc": "residual of the coupling of lattice and rotors over the flight speed"},
    "dynamic_pressure": {"units": "Pa", "desc": "dynamic pressure of the free stream"},
    "q_S": {"units": "N", "desc": "dynamic pressure times reference area"},
    "speed": {"units": "m/s", "desc": "true airspeed"},
    "density": {"units": "kg/m**3", "desc": "density of the air"},
    "rotor_hub": {"units": "m", "desc": "hubs of the starboard rotors, inner first within a group"},
    "rotor_force": {"units": "N", "desc": "force of each starboard rotor on the aircraft, geometry axes"},
    "rotor_moment": {"units": "N*m", "desc": "moment of each starboard rotor about its hub, geometry axes"},
    "y_span": {"units": "m", "desc": "middles of the wing's strips"},
    "strip_edge": {"units": "m", "desc": "y of the edges of the wing's strips"},
    "strip_point": {"units": "m", "desc": "quarter-chord points of the wing's strips"},
    "strip_force": {"units": "N", "desc": "force on each strip of the starboard wing, geometry axes"},
    "strip_moment": {"units": "N*m", "desc": "moment on each strip about its point, geometry axes"},
    "strip_lift_by_twist": {"units": "N/rad", "desc": "lift of each strip of the wing (rows) by the incidence of each"},
}
