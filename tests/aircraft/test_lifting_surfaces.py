"""Further lifting surfaces: what they hold, the one form of all surfaces, strips, faults."""

import math
import tomllib
from pathlib import Path

import numpy as np
import pytest

from hera_om.aircraft import (
    command_limit_deg,
    commands,
    definition_hash,
    dumps,
    lifting_surfaces,
    load_aircraft,
    loads,
    numbers,
    replace_numbers,
)
from hera_om.aircraft.spacing import avl_counts, law_at, law_number, law_text, segment_points, segments
from hera_om.core.errors import InputError

TEXT = """
name = "three surfaces"

[flight]
mach = 0.3
delta_r_deg = 2.0

[reference]
S_m2 = 20.0
c_m = 2.0
b_m = 10.0

[[surface]]
name = "main"
incidence_deg = 1.0
spacing = "sine"
chordwise = 5

[[surface.section]]
name = "root"
x_le_m = 1.0
chord_m = 2.0
airfoil = "NACA 2412"
strips = 4

[[surface.section]]
name = "bend"
x_le_m = 1.0
y_m = 4.0
chord_m = 2.0
strips = 3
spacing = "1.5"

[[surface.section]]
name = "tip"
x_le_m = 2.0
y_m = 4.0
z_m = 1.0
chord_m = 1.0
twist_deg = -2.0

[[surface.control]]
name = "outer"
command = "delta_a"
inner = 0.4
outer = 0.8
hinge = 0.7
hinge_outer = 0.75
limit_deg = 20.0

[[surface]]
name = "fin"
side = "plane"

[[surface.section]]
name = "root"
x_le_m = 6.0
chord_m = 2.0

[[surface.section]]
name = "tip"
x_le_m = 7.0
z_m = 2.0
chord_m = 1.0

[[surface.control]]
name = "rudder"
command = "delta_r"
hinge = 0.6
gain = -2.0
gain_outer = -1.0
limit_deg = 24.0
axis_x = 0.0
axis_y = 0.0
axis_z = 1.0
"""


def report(text):
    with pytest.raises(InputError) as caught:
        loads(text, "x.toml")
    return caught.value


def test_a_definition_of_surfaces_survives_writing():
    aircraft = loads(TEXT)
    assert loads(dumps(aircraft)) == aircraft
    assert definition_hash(loads(dumps(aircraft))) == definition_hash(aircraft)
    present = numbers(aircraft)
    assert present["surface.main.section.tip.twist_deg"] == -2.0
    assert present["surface.fin.control.rudder.gain"] == -2.0


def test_the_one_form_of_further_surfaces():
    main, fin = lifting_surfaces(loads(TEXT))
    assert (main.name, main.symmetric, main.in_plane) == ("main", True, False)
    assert (fin.symmetric, fin.in_plane) == (False, True)
    assert main.station == (0.0, 4.0, 5.0)  # along y, then up
    assert (main.chordwise, main.spanwise, fin.chordwise, fin.spanwise) == (5, 7, 6, 12)
    assert [(s.count, s.law, s.start, s.end) for s in main.segments] == [(4, -2.0, 0.0, 4 / 7), (3, 1.5, 0.0, 1.0)]
    aileron = main.controls[0]
    assert (aileron.ends, aileron.hinge, aileron.gain, aileron.mirror) == ((2.0, 4.0), (0.7, 0.75), (1.0, 1.0), -1.0)
    rudder = fin.controls[0]
    assert (rudder.ends, rudder.gain, rudder.axis) == ((0.0, 2.0), (-2.0, -1.0), (0.0, 0.0, 1.0))


def test_commands_and_their_limits():
    aircraft = loads(TEXT)
    assert commands(aircraft) == ("delta_a", "delta_r")
    assert command_limit_deg(aircraft, "delta_a") == 20.0
    assert command_limit_deg(aircraft, "delta_r") == 12.0  # 24 degrees at a gain of 2
    assert command_limit_deg(aircraft, "delta_e") is None
    assert commands(load_aircraft("hera_like")) == ("delta_e", "delta_a", "delta_r", "delta_f")


def test_wing_and_tails_in_the_one_form_are_those_of_the_reference(reference):
    """Sections that the ATR-like case states for AVL, against our tail by area, aspect ratio and taper."""
    source = tomllib.loads((reference / "atr_like" / "wing_tail.toml").read_text("utf-8"))
    wing, tail, fin = lifting_surfaces(load_aircraft("wing_tail"))
    for surface, table in ((wing, "wing"), (tail, "htp"), (fin, "vtp")):
        rows = np.array(source[table]["sections"])
        if table == "wing":  # with sections at the ends of the aileron, on the straight lines between the others
            rows = np.stack([np.interp(surface.y, rows[:, 0], column) for column in rows.T], axis=1)
        places = zip(surface.x_le, surface.z, surface.chord, surface.twist_deg, strict=True)
        got = [[y, x, z, c, t] for y, (x, z, c, t) in zip(surface.y, places, strict=True)]
        np.testing.assert_allclose(got, rows, atol=1e-6)
    assert tail.controls[0].hinge == (0.65, 0.65) and tail.controls[0].gain == (1.0, 1.0)


def test_the_fin_of_the_one_form():
    aircraft = load_aircraft("hera_like")
    fin = lifting_surfaces(aircraft)[2]
    height = fin.z[1] - fin.z[0]
    assert fin.name == "vtail" and fin.in_plane and fin.y == (0.0, 0.0) and fin.station == (0.0, height)
    area = (fin.chord[0] + fin.chord[1]) / 2 * height
    assert area == pytest.approx(aircraft.vtail.S_m2) and height**2 / area == pytest.approx(aircraft.vtail.aspect_ratio)
    quarter = [x + c / 4 for x, c in zip(fin.x_le, fin.chord, strict=True)]
    sweep = math.degrees(math.atan((quarter[1] - quarter[0]) / height))
    assert sweep == pytest.approx(aircraft.vtail.sweep_quarter_deg)
    # trailing edge to port is against the right-hand rule about an axis that runs up
    assert fin.controls[0].gain[0] == -aircraft.vtail.control.rudder.gain and fin.controls[0].mirror == -1.0


def test_panels_of_the_fin_follow_the_tail_unless_given():
    base = load_aircraft("hera_like")
    changed = load_aircraft("hera_like", {"lattice.fin_chordwise": 3, "lattice.fin_spanwise": 7})
    of = {a: (lifting_surfaces(a)[2].chordwise, lifting_surfaces(a)[2].spanwise) for a in (base, changed)}
    assert of[base] == (base.lattice.tail_chordwise, base.lattice.tail_spanwise) and of[changed] == (3, 7)


def test_the_one_form_passes_traced_numbers_through():
    import jax
    import jax.numpy as jnp

    from hera_om.components.structure import Structure, number_array

    aircraft = load_aircraft("hera_like")
    text = TEXT.replace("strips = 4\n", "").replace('strips = 3\nspacing = "1.5"\n', "")
    extra = loads(text).surface
    aircraft = aircraft.model_copy(update={"surface": extra})
    structure, base = Structure(aircraft), number_array(aircraft)

    def leaves(values):
        surfaces = lifting_surfaces(structure.aircraft(values, {}), jnp.tan)
        return jnp.stack([jnp.asarray(v) for s in surfaces for v in _numbers_of(s)])

    tangent = jax.jit(jax.jacfwd(leaves))(jnp.asarray(base))
    paths = list(numbers(aircraft))
    plain = np.array([v for s in lifting_surfaces(aircraft) for v in _numbers_of(s)])
    main = ("surface.main.section.tip.z_m", "surface.main.control.outer.outer")
    for path in ("htail.scale", "vtail.sweep_quarter_deg", *main):
        h = 1e-6
        moved = replace_numbers(aircraft, {path: numbers(aircraft)[path] + h})
        differences = (np.array([v for s in lifting_surfaces(moved) for v in _numbers_of(s)]) - plain) / h
        column = np.asarray(tangent)[:, paths.index(path)]
        assert np.any(column) and np.max(np.abs(column - differences)) < 1e-4 * np.max(np.abs(column)), path


def _numbers_of(surface):
    """Every number of the one form, flat."""
    rows = [*surface.x_le, *surface.y, *surface.z, *surface.chord, *surface.twist_deg, *surface.station]
    rows.append(surface.incidence_deg)
    for control in surface.controls:
        rows += [*control.ends, *control.hinge, *control.gain, control.mirror]
    return rows


# --- strips


def test_laws_of_spacing():
    """AVL's user primer, vortex lattice spacing distributions: what each number means."""
    u = np.linspace(0.0, 1.0, 9)
    at = {law: np.array([law_at(law, v) for v in u]) for law in (0.0, 1.0, 2.0, -2.0, 3.0, 1.5, -1.0)}
    np.testing.assert_allclose(at[0.0], u)
    np.testing.assert_allclose(at[3.0], u)
    np.testing.assert_allclose(at[1.0], (1 - np.cos(np.pi * u)) / 2)
    np.testing.assert_allclose(at[-1.0], at[1.0])
    np.testing.assert_allclose(at[2.0], 1 - np.cos(np.pi * u / 2))
    np.testing.assert_allclose(at[-2.0], np.sin(np.pi * u / 2))
    np.testing.assert_allclose(at[1.5], (at[1.0] + at[2.0]) / 2)


@pytest.mark.parametrize("text", ["uniform", "cosine", "sine", "sine-inner", "1.5", "-0.25"])
def test_laws_by_word_and_number(text):
    assert law_text(law_number(text)) == text


def test_a_part_of_a_law_is_what_avl_stretches():
    """Twelve strips by a cosine law over sections at 0, 0.3, 1: AVL moves the nearest edge to the section."""
    counts = avl_counts((0.0, 3.0, 10.0), 12, 1.0)
    edges = (1 - np.cos(np.pi * np.arange(13) / 12)) / 2
    nearest = int(np.argmin(np.abs(edges - 0.3)))
    assert counts == (nearest, 12 - nearest)
    inner, outer = segments(counts, (None, None), 1.0)
    np.testing.assert_allclose(segment_points(inner)[::2], edges[: nearest + 1] / edges[nearest])
    rest = (edges[nearest:] - edges[nearest]) / (1 - edges[nearest])
    np.testing.assert_allclose(segment_points(outer)[::2], rest)
    middle = (1 - np.cos(np.pi * 0.5 / 12)) / 2 / edges[nearest]
    assert segment_points(inner)[1] == pytest.approx(middle)
    assert avl_counts((0.0, 4.9, 5.0, 10.0), 4, 0.0) is None


# --- faults

TIP = 'name = "tip"\nx_le_m = 2.0\ny_m = 4.0\nz_m = 1.0'
FAULTS = [
    (TIP, 'name = "tip"\nx_le_m = 2.0\ny_m = 4.0\nz_m = 0.0', "surface.main.section.tip.y_m", "zero width"),
    (TIP, 'name = "bend"\nx_le_m = 2.0\ny_m = 4.0\nz_m = 1.0', "surface.main.section.bend.name", "stands once"),
    ("y_m = 4.0\nchord_m = 2.0", "y_m = -4.0\nchord_m = 2.0", "surface.main.section.bend.y_m", ">= 0"),
    ("y_m = 4.0\nchord_m = 2.0", "y_m = 4.0\nchord_m = 0.0", "surface.main.section.bend.chord_m", "> 0"),
    ('name = "fin"', 'name = "main"', "surface.main.name", "stands once"),
    ('name = "fin"', 'name = "wing"', "surface.wing.name", "name other parts"),
    ('name = "fin"', 'name = "rotors"', "surface.rotors.name", "name other parts"),
    ('side = "plane"', 'side = "one"', "surface.fin.side", "'plane'"),
    ("x_le_m = 7.0", "x_le_m = 7.0\ny_m = 0.1", "surface.fin.section.tip.y_m", "in the plane y = 0"),
    ("inner = 0.4", "inner = 0.8", "surface.main.control.outer.inner", "positive width"),
    ("inner = 0.4", "inner = -0.1", "surface.main.control.outer.inner", ">= 0"),
    ("outer = 0.8", "outer = 1.2", "surface.main.control.outer.outer", "<= 1"),
    ("hinge = 0.7\n", "hinge = 1.7\n", "surface.main.control.outer.hinge", "< 1"),
    ("hinge_outer = 0.75", "hinge_outer = -0.1", "surface.main.control.outer.hinge_outer", ">= 0"),
    ('command = "delta_a"', 'command = "delta_x"', "surface.main.control.outer.command", "'delta_e' or"),
    ("axis_x = 0.0\n", "", "surface.fin.control.rudder.axis_x", "all three"),
    ("axis_z = 1.0", "axis_z = 0.0", "surface.fin.control.rudder.axis_x", "a direction"),
    ("axis_x = 0.0", "mirror = 1.0\naxis_x = 0.0", "surface.fin.control.rudder.mirror", "no mirrored half"),
    ("strips = 4\n", "", "surface.main.section.root.strips", "of every segment or of none"),
    ("strips = 4\n", "strips = 0\n", "surface.main.section.root.strips", ">= 1"),
    ('spacing = "1.5"', 'spacing = "3.5"', "surface.main.section.bend.spacing", "AVL's number"),
    ("twist_deg = -2.0", "twist_deg = -2.0\nstrips = 3", "surface.main.section.tip.strips", "last section"),
    ("chordwise = 5", "chordwise = 5\nspanwise = 9", "surface.main.spanwise", "absent where sections"),
    ('airfoil = "NACA 2412"', 'airfoil = "mh60"', "surface.main.section.root.airfoil", "name of an [[airfoil]]"),
    ("delta_r_deg = 2.0", "delta_e_deg = 2.0", "flight.delta_e_deg", "no surface has a control"),
    ("mach = 0.3", "mach = 1.0", "flight.mach", "< 1"),
    ("S_m2 = 20.0\n", "", "reference.S_m2", "no wing gives one"),
]


@pytest.mark.parametrize(("old", "new", "key", "expected"), FAULTS, ids=[f"{f[2]}-{f[3]}" for f in FAULTS])
def test_fault_of_a_surface_is_named(old, new, key, expected):
    assert old in TEXT
    error = report(TEXT.replace(old, new, 1))
    assert [p for p in error.problems if p.key == key and expected in p.expected], str(error)
    assert all(p.file == "x.toml" for p in error.problems)


def test_faults_of_several_surfaces_are_in_one_report():
    text = TEXT.replace("inner = 0.4", "inner = 0.9", 1).replace("x_le_m = 7.0\nz_m = 2.0", "x_le_m = 7.0\nz_m = 0.0")
    assert {p.key for p in report(text).problems} >= {"surface.main.control.outer.inner", "surface.fin.section.tip.y_m"}


def test_a_corner_of_the_variables_that_folds_a_surface_is_found():
    box = '\n[[variables]]\nname = "rise"\npath = "surface.main.section.tip.z_m"\nlower = 0.0\nupper = 2.0\n'
    error = report(TEXT + box)
    assert [p for p in error.problems if "zero width" in p.expected and "corner rise = 0" in p.expected]


def test_example_of_the_page_is_part_of_a_definition():
    page = (Path(__file__).parents[2] / "docs" / "definition.md").read_text("utf-8")
    block = page.split("```toml\n")[2].split("```")[0]
    fin = lifting_surfaces(loads(TEXT.split("[[surface]]")[0] + block))[0]
    assert fin.in_plane and fin.controls[0].command == "delta_r"
