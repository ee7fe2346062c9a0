"""Box shape, section properties and shear flow: finite elements, textbook boxes, hand formulas."""

import csv

import jax.numpy as jnp
import numpy as np
import pytest

from hera_om.core.contours import contour_table
from hera_om.physics.beam_loads import Loads
from hera_om.physics.box_contour import CORNERS, COVER_POINTS, LOWER, SEGMENT_PANEL, UPPER, BoxShape, box_shape
from hera_om.physics.box_section import (
    BoxMembers,
    box_members,
    cap_depth,
    section_properties,
    shear_flow,
    z_stringer,
)
from hera_om.physics.wingbox import box_model
from hera_om.physics.wingbox_beam import wing_beam
from hera_om.physics.wingbox_criteria import box_state
from hera_om.physics.wingbox_types import BoxConcept, BoxGeometry, BoxLoads, Material, on_sections

W, H = 1.2, 0.4
# Airfoil, chord, t/c, spars, sheets, members; as in tests/reference/box_sections.py.
SECTIONS = {
    "root_43018": ("NACA 43018", 2.77, 0.18, 0.15, 0.62, (0.005, 0.0022, 0.0068, 0.0053), None),
    "tip_43013": ("NACA 43013", 1.61, 0.13, 0.15, 0.62, (0.0016, 0.0014, 0.002, 0.0017), None),
    "naca_2412": ("NACA 2412", 2.0, 0.12, 0.10, 0.70, (0.003, 0.003, 0.003, 0.003), None),
    "naca_4418": ("NACA 4418", 3.0, 0.18, 0.20, 0.65, (0.004, 0.006, 0.003, 0.010), None),
    "members": ("NACA 43018", 2.77, 0.18, 0.15, 0.62, (0.0015, 0.001, 0.002, 0.0016), (1.5e-3, 3.5e-4, 8.0)),
}
FLOWS = ("J", "x_sc", "q_front", "q_rear")


def rectangle(width=W, height=H):
    """A rectangular box through the general shape: the contour's ordinates replaced."""
    shape = box_shape(jnp.asarray([width]), jnp.asarray([0.2]), front_spar=0.1, rear_spar=0.9)
    x = (shape.x - shape.x[0]) / (shape.x[CORNERS[2]] - shape.x[0]) * width
    z = jnp.full_like(x, -height / 2).at[1 : CORNERS[3]].set(height / 2)
    length = jnp.hypot(jnp.roll(x, -1, 0) - x, jnp.roll(z, -1, 0) - z)
    w, h = jnp.asarray([width]), jnp.asarray([height])
    return BoxShape(x, z, length, jnp.stack([w, w]), w, h, h, h, w * h)


def members(cap=0.0, stringer=1e-9, number=0.0):
    return BoxMembers(jnp.asarray([cap]), jnp.asarray([stringer]), jnp.asarray([number]))


def sheets(*t):
    return jnp.asarray(t)[:, None]


def properties(shape, given, t):
    """What the reference file lists, with webs' flows signed upwards."""
    section = section_properties(shape, given, t)
    flow = shear_flow(shape, section, t)
    up = flow.middle[1, :, 0]
    return {
        "area": section.area[0],
        "x_c": section.x_centroid[0],
        "z_c": section.z_centroid[0],
        "I_xx": section.I_xx[0],
        "I_zz": section.I_zz[0],
        "I_xz": section.I_xz[0],
        "J": section.torsion_constant[0],
        "x_sc": flow.x_shear_centre[0],
        "z_sc": flow.z_shear_centre[0],
        "q_front": up[0],
        "q_rear": -up[CORNERS[2]],
    }


@pytest.fixture(scope="module")
def finite_elements(reference):
    with (reference / "box_sections.csv").open(newline="") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        return {row.pop("name"): {k: float(v) for k, v in row.items()} for row in rows}


def compare(found, expected, size, tolerance):
    """Lengths relative to the box, the product of inertia to the second moments, all else to itself."""
    scale = {"x_c": size[0], "x_sc": size[0], "z_c": size[1], "z_sc": size[1]}
    scale["I_xz"] = np.sqrt(expected["I_xx"] * expected["I_zz"])
    for name, value in expected.items():
        allowed = tolerance(name) * scale.get(name, abs(value))
        assert float(found[name]) == pytest.approx(value, abs=allowed), name


def test_rectangle_against_finite_elements(finite_elements):
    found = properties(rectangle(), members(), sheets(0.003, 0.003, 0.004, 0.006))
    compare(found, finite_elements["rectangle"], (W, H), lambda name: 0.01)


@pytest.mark.parametrize("name", SECTIONS)
def test_sections_against_finite_elements(name, finite_elements):
    airfoil, chord, ratio, front, rear, t, extra = SECTIONS[name]
    tables = jnp.asarray(contour_table(airfoil))[None]
    shape = box_shape(jnp.asarray([chord]), jnp.asarray([ratio]), front_spar=front, rear_spar=rear, tables=tables)
    found = properties(shape, members(*extra) if extra else members(), sheets(*t))
    size = float(shape.width[0]), float(shape.h_mean[0])
    # Solid flanges stiffen the wall that they lie on, a tenth of the covers.
    compare(found, finite_elements[name], size, lambda k: 0.035 if extra and k in FLOWS else 0.01)


def test_thin_rectangular_box_by_hand():
    t_c, t_w = 0.003, 0.005
    section = section_properties(rectangle(), members(), sheets(t_c, t_c, t_w, t_w))
    assert float(section.area[0]) == pytest.approx(2 * W * t_c + 2 * H * t_w, rel=1e-12)
    assert float(section.I_xx[0]) == pytest.approx(2 * W * t_c * H**2 / 4 + 2 * t_w * H**3 / 12, rel=1e-12)
    assert float(section.I_zz[0]) == pytest.approx(2 * t_c * W**3 / 12 + 2 * H * t_w * W**2 / 4, rel=1e-12)
    np.testing.assert_allclose([section.z_centroid[0], section.I_xz[0]], 0.0, atol=1e-15)
    bredt = 4 * (W * H) ** 2 / (2 * W / t_c + 2 * H / t_w)
    assert float(section.torsion_constant[0]) == pytest.approx(bredt, rel=1e-12)


def test_unequal_covers_caps_and_stringers_by_parallel_axes():
    cap, stringer, number = 2e-3, 3e-4, 5.0
    section = section_properties(rectangle(), members(cap, stringer, number), sheets(0.005, 0.002, 0.004, 0.003))
    depth = float(z_stringer(jnp.asarray([stringer])).centroid[0])
    sink = float(cap_depth(jnp.asarray([cap]))[0])
    parts = [(W * 0.005, H / 2, 0.0), (W * 0.002, -H / 2, 0.0), (H * 0.007, 0.0, 0.007 * H**3 / 12)]
    parts += [(2 * cap, s * (H / 2 - sink), 0.0) for s in (1, -1)]
    parts += [(number * stringer, s * (H / 2 - depth), 0.0) for s in (1, -1)]
    area = sum(a for a, _, _ in parts)
    z_c = sum(a * z for a, z, _ in parts) / area
    inertia = sum(i + a * (z - z_c) ** 2 for a, z, i in parts)
    assert float(section.z_centroid[0]) == pytest.approx(z_c, rel=1e-12)
    assert float(section.I_xx[0]) == pytest.approx(inertia, rel=1e-12)
    upper = jnp.sum(section.sheet_moments[1, UPPER]) + jnp.sum(section.cap_moments[1, CORNERS[1:3]])
    assert float(upper) == pytest.approx(sum(a * (z - z_c) for a, z, _ in parts if z > 0), rel=1e-12)


def test_flow_of_a_rectangular_tube_by_hand():
    """Doubly symmetric box: q of the webs' middle = V / I (t_c W H / 4 + t_w H^2 / 8), half of it each side."""
    t_c, t_w = 0.003, 0.005
    t = sheets(t_c, t_c, t_w, t_w)
    shape = rectangle()
    section = section_properties(shape, members(), t)
    flow = shear_flow(shape, section, t)
    by_hand = (t_c * W * H / 4 + t_w * H**2 / 8) / float(section.I_xx[0])
    np.testing.assert_allclose(flow.middle[1, [0, CORNERS[2]], 0], [by_hand, -by_hand], rtol=1e-12)
    aft = (t_w * H * W / 4 + t_c * W**2 / 8) / float(section.I_zz[0])
    np.testing.assert_allclose(flow.end[0, CORNERS[1] + 5, 0], aft, rtol=1e-12)  # half way along the upper cover
    assert float(flow.x_shear_centre[0]) == pytest.approx(W / 2, rel=1e-12)
    assert float(flow.z_shear_centre[0]) == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("direction", [0, 1])
def test_flow_is_in_equilibrium_with_its_force(direction):
    shape = box_shape(
        jnp.asarray([2.5]),
        jnp.asarray([0.17]),
        front_spar=0.15,
        rear_spar=0.6,
        tables=jnp.asarray(contour_table("NACA 4418"))[None],
    )
    t = sheets(0.005, 0.002, 0.006, 0.004)
    flow = shear_flow(shape, section_properties(shape, members(), t), t)
    # Simpson's rule is exact for the parabola of each segment.
    mean = ((flow.start + 4 * flow.middle + flow.end) / 6)[direction, :, 0]
    steps = [np.asarray(jnp.roll(c, -1, 0) - c)[:, 0] for c in (shape.x, shape.z)]
    np.testing.assert_allclose([mean @ s for s in steps], np.eye(2)[direction], atol=1e-12)
    thickness = np.asarray(t)[SEGMENT_PANEL, 0]
    assert mean @ (np.asarray(shape.length)[:, 0] / thickness) == pytest.approx(0.0, abs=1e-9)  # no twist


def test_shape_follows_the_contour():
    chord, ratio, x = 2.77, 0.18, np.linspace(0.15, 0.62, 20001)
    tables = jnp.asarray(contour_table("NACA 43018"))[None]
    shape = box_shape(jnp.asarray([chord]), jnp.asarray([ratio]), front_spar=0.15, rear_spar=0.62, tables=tables)
    half = 5 * ratio * (0.2969 * np.sqrt(x) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1015 * x**4)
    assert float(shape.width[0]) == pytest.approx(0.47 * chord, rel=1e-12)
    np.testing.assert_allclose([shape.h_front[0], shape.h_rear[0]], 2 * chord * half[[0, -1]], rtol=1e-7)
    assert float(shape.h_mean[0]) == pytest.approx(2 * chord * np.trapezoid(half, x) / 0.47, rel=1.5e-3)
    m, k = 0.2025, 2 * 15.957
    mean = np.where(x < m, k / 6 * (x**3 - 3 * m * x**2 + m**2 * (3 - m) * x), k / 6 * m**3 * (1 - x))
    for side, sign in ((UPPER, 1.0), (LOWER, -1.0)):
        nodes = np.asarray(shape.x[side, 0]) / chord, np.asarray(shape.z[side, 0]) / chord
        np.testing.assert_allclose(nodes[1], np.interp(nodes[0], x, mean + sign * half), atol=1e-6)


def test_members_follow_the_area_law_and_z_proportions():
    chord, ratio = jnp.asarray([2.77, 1.61]), jnp.asarray([0.18, 0.13])
    shape = box_shape(chord, ratio, front_spar=0.15, rear_spar=0.62)
    given = box_members(shape, chord, A_cap_root=3e-3, A_stringer_root=3.5e-4, pitch=0.15)
    law = (1.61 / 2.77) ** 2 * 0.13 / 0.18
    np.testing.assert_allclose(given.A_cap, [3e-3, 3e-3 * law], rtol=1e-12)
    np.testing.assert_allclose(given.A_stringer, [3.5e-4, 3.5e-4 * law], rtol=1e-12)
    np.testing.assert_allclose(given.n_stringer, [0.47 * 2.77 / 0.15 - 1, 0.47 * 1.61 / 0.15 - 1], rtol=1e-12)
    z = z_stringer(given.A_stringer)
    sheet = z.height / 16
    np.testing.assert_allclose(1.8 * z.height * sheet, given.A_stringer, rtol=1e-12)
    inertia = sheet * z.height**3 / 12 + 2 * 0.4 * z.height * sheet * (z.height / 2) ** 2
    np.testing.assert_allclose(z.gyration_square, inertia / given.A_stringer, rtol=1e-12)


def test_derivatives_of_properties_and_flow(check_derivatives):
    tables = jnp.asarray(contour_table("NACA 43018"))[None]

    def outputs(p):
        chord, ratio = p[0:1] * 2.5, p[1:2] * 0.17
        shape = box_shape(chord, ratio, front_spar=0.15 * p[2], rear_spar=0.6 * p[3], tables=tables)
        m = box_members(shape, chord, A_cap_root=3e-3 * p[4], A_stringer_root=3e-4 * p[5], pitch=0.15 * p[6])
        t = jnp.asarray([0.005, 0.002, 0.006, 0.004])[:, None] * p[7]
        section = section_properties(shape, m, t)
        flow = shear_flow(shape, section, t)
        moments = section.area * 50, section.I_xx * 1e3, section.I_xz * 1e3, section.torsion_constant * 1e3
        return jnp.concatenate([*moments, flow.middle.ravel(), flow.x_shear_centre, flow.z_shear_centre])

    # The curvature of the table's cubics jumps at its points: short steps for the spars.
    check_derivatives(outputs, [1.03, 0.98, 1.02, 0.97, 1.05, 1.1, 0.9, 1.04], relative_step=3e-4)


@pytest.mark.parametrize("incidence", [0.0, 0.08, -0.5])
def test_a_turned_section_by_hand(incidence):
    """Polygon of sheets turned nose-up in numpy, stresses by Megson's eq. 16.18 on geometry axes, and stiffness."""
    chord, ratio, t = 2.5, 0.16, np.array([0.004, 0.003, 0.005, 0.006])
    case = {"V": 0.0, "M": 4e5, "T": 0.0, "H": 0.0, "Mz": -1.5e5}
    loads = BoxLoads(**{k: jnp.full((1, 2), v) for k, v in case.items()})
    edge = jnp.asarray([[0.0, 1.0, 0.0], [0.0, 2.0, 0.0]])
    tables = jnp.asarray(np.stack([contour_table("NACA 4415")] * 2))
    how = {"tables": tables, "incidence": jnp.full(2, incidence)}
    geometry = BoxGeometry(edge, jnp.full(2, chord), jnp.full(2, ratio), **how)
    metal = Material(7e10, 2.7e10, 0.3, 2800.0, 4e8, 4e8, 5e8, 3e8)
    concept = BoxConcept(0.15, 0.62, 0.6, 0.15, 0.001)
    model = box_model(geometry, metal, concept, loads=loads, A_cap_root=1e-12, A_stringer_root=1e-15)
    state = box_state(model, jnp.asarray(t)[:, None] * jnp.ones(2))
    x, z = np.asarray(model.shape.x[:, 0]) - 0.35 * chord, np.asarray(model.shape.z[:, 0])
    x, z = x * np.cos(incidence) + z * np.sin(incidence), z * np.cos(incidence) - x * np.sin(incidence)
    x2, z2 = np.roll(x, -1), np.roll(z, -1)
    area = t[SEGMENT_PANEL] * np.hypot(x2 - x, z2 - z)
    xc, zc = area @ (x + x2) / 2 / area.sum(), area @ (z + z2) / 2 / area.sum()
    x, z, x2, z2 = x - xc, z - zc, x2 - xc, z2 - zc
    xx, zz = area @ (z * z + z * z2 + z2 * z2) / 3, area @ (x * x + x * x2 + x2 * x2) / 3
    xz = area @ (2 * (x * z + x2 * z2) + x * z2 + x2 * z) / 6
    b, c = np.linalg.solve([[zz, xz], [xz, xx]], [case["Mz"], -case["M"]])
    np.testing.assert_allclose(state.direct[:2, :, 0, 0], (b * x + c * z)[COVER_POINTS], rtol=1e-6)
    weight = Loads(*(jnp.asarray([100.0, 0.0]) for _ in Loads._fields))
    beam = wing_beam(geometry, metal, state.section, weight)
    np.testing.assert_allclose(beam.EI[0], metal.E * (xx - xz**2 / zz), rtol=1e-6)


def test_forces_and_torque_turn_with_the_section():
    """Loads that turn with the section stress it as before: by a vector's own rotation, nose-up about +y."""
    i, random = 0.3, np.random.default_rng(4)
    v, m, t, h, mz = random.normal(size=(5, 1, 3))
    turn = np.array([[np.cos(i), 0, np.sin(i)], [0, 1, 0], [-np.sin(i), 0, np.cos(i)]])  # nose up: aft goes down
    force, moment = (np.stack([a, 0 * a, b]) for a, b in ((h, v), (m, mz)))
    force, moment = (np.einsum("ij,jcn->icn", turn, w) for w in (force, moment))
    turned = on_sections(BoxLoads(force[2], moment[0], t, force[0], moment[2]), i)
    np.testing.assert_allclose(np.stack(turned), np.stack([v, m, t, h, mz]), atol=1e-12)
