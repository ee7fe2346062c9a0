"""Write docs/validation.md: the numbers of the validation tests, from the functions that the tests use.

Run by ``make validation``.
"""

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

ROOT = Path(__file__).resolve().parents[1]
REFERENCE = ROOT / "tests" / "reference"
HEAD = """# Validation

Written by `make validation` from the functions that the tests call; do not edit. Each row is held by a test,
to the tolerance in the last column where there is one. Beside these rows, tests hold the rotor to CCBlade, to a
closed form and to a measured propeller, the beam, plates and box to closed forms, and the equations of motion to
published modes: see the tests of the same names in `tests/physics/`.

With `[lattice] convention = "avl"` (`geometry.FLAT`) AVL is reproduced digit by digit on its own lattice: panels on
the untwisted chord surface, camber, incidence and deflections through the normals, chord times sine of the incidence
linear between sections, force on spanwise filaments only, cores of vortices between components, wake along x. The
default convention (`geometry.CAMBER`) puts the panels on the twisted camber surface, takes incidence linear between
sections, and lets every bound filament carry its force; its rows stand apart.

What is left of the elliptic wing is no error of the lattice: a lifting surface has CL^2 / (pi AR) only in the
limit of the aspect ratio. At AR 6 the excess is 0.13 % on 20 or 40 strips, whatever the chord of the tip; it
is 0.02 to 0.05 % with the middle of the chord straight, 0.5 % with a straight leading edge.

The near-field drag of lifting lines that bend (a straight leading edge with one row of panels: 6 % too much)
is poorer than that of the Trefftz plane, which the build-up uses.
"""
SIDESLIP = """
Lateral derivatives in the default convention, not held: AVL puts no force on chordwise filaments. In sideslip they
carry one, and with it roll by sideslip grows with lift, as it does on real wings.
"""
BLOWN = """What propellers add to wings in wind tunnels. The tolerances are what is reached, not what was wished: see
`docs/theory/rotors_and_slipstream.md`, which also has the loads along the span (Model I, DUST) and
what isolates their causes.
"""
LINE = "| {} | {} | {:.6g} | {:.6g} | {:+.2f} % | {} | {:.2g} % |"


def load(path: Path) -> ModuleType:
    """A test module or plugin, by its file."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    if spec is None or spec.loader is None:
        raise ImportError(f"cannot load {path}")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def table(rows, *, held: bool = True) -> list[str]:
    """Rows (case, quantity, reference, ours, tolerance, source); without the tolerance if no test holds them."""
    out = [
        "| case | quantity | reference | ours | difference | source | tolerance |",
        "|---|---|---|---|---|---|---|",
    ]
    for case, quantity, expected, ours, tolerance, source in rows:
        difference = 100 * (ours / expected - 1)
        line = LINE.format(case, quantity, expected, ours, difference, source, 100 * tolerance)
        out.append(line if held else f"{line.rsplit('|', 2)[0]}| |")
    return [*out, ""]


def mutations(plugin: ModuleType) -> list[str]:
    """The table of mutations."""
    out = ["| effect switched off | where, in `hera_om.physics` | test that fails |", "|---|---|---|"]
    for row in plugin.MUTATIONS.values():
        places = ", ".join(f"`{place.replace(':', '.')}`" for place in row.places)
        out.append(f"| {row.effect} | {places} | `{row.test.removeprefix('tests/')}` |")
    return [*out, ""]


def document() -> str:
    """The whole page."""
    tests = ROOT / "tests" / "physics"
    wing, aircraft = load(tests / "test_lattice.py"), load(tests / "test_aerodynamics.py")
    avl, unsteady = load(tests.parent / "components" / "test_avl_case.py"), load(tests / "test_unsteady_lattice.py")
    order, blown = load(tests / "test_lattice_order.py"), load(tests.parent / "components" / "test_propeller_wing.py")
    page = [HEAD, "## Wings alone", ""]
    cases = (
        wing.simple_wing_rows,
        wing.simple_wing_derivative_rows,
        wing.strip_rows,
        wing.warren_rows,
        wing.bertin_rows,
        wing.elliptic_rows,
        wing.rectangular_rows,
    )
    page += table([row for case in (*cases, order.bertin_converged_rows) for row in case(REFERENCE)])
    page += ["## Wing and tail", ""]
    tags = ("base", "fine", "base_m04")
    page += table([row for tag in tags for row in aircraft.wing_tail_rows(REFERENCE, tag)])
    page += ["### The same from AVL's own file", ""]
    page += table(avl.avl_rows(REFERENCE, avl.build(REFERENCE)))
    held, stated = aircraft.camber_rows(REFERENCE)
    page += ["## The default convention, `CAMBER`", ""]
    page += table([*wing.simple_wing_rows(REFERENCE, wing.CAMBER, 0.004), *held])
    page += [SIDESLIP, *table(stated, held=False)]
    page += ["## Unsteady flow", ""]
    page += table(unsteady.theodorsen_rows(REFERENCE))
    page += ["## Propellers and wings", "", BLOWN]
    tunnels = (blown.model_II_rows, blown.model_II_tip_rows, blown.model_I_rows, blown.prowim_rows)
    page += table([row for rows in tunnels for row in rows(REFERENCE)])
    page += ["## Mutations", "", "`make mutations` switches each effect off and sees its test fail.", ""]
    page += mutations(load(ROOT / "tests" / "mutations" / "plugin.py"))
    return "\n".join(page)


if __name__ == "__main__":
    target = ROOT / "docs" / "validation.md"
    target.write_text(document(), encoding="utf-8")
    sys.stdout.write(f"{target.relative_to(ROOT)} written\n")
