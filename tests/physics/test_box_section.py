"""Box geometry, section properties and shear flow against hand formulas and an independent boom model."""

import jax.numpy as jnp
import numpy as np
import pytest

from hera_om.physics.box_section import (
    BoxMembers,
    BoxShape,
    box_members,
    box_shape,
    cap_depth,
    section_properties,
    shear_flow,
    z_stringer,
)

W, H = 1.2, 0.4


def rectangle(width=W, height=H):
    w, h = jnp.asarray([width]), jnp.asarray([height])
    return BoxShape(w, h, h, h, h**2 / 4, h / 2, w * h)


def members(cap=0.0, stringer=1e-9, number=0.0):
    return BoxMembers(jnp.asarray([cap]), jnp.asarray([stringer]), jnp.asarray([number]))


def sheets(*t):
    return jnp.asarray(t)[:, None]


def naca(x, ratio):
    """Half thickness over chord, straight from Abbott & von Doenhoff eq. 6.2."""
    poly = 0.2969 * np.sqrt(x) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1015 * x**4
    return ratio / 0.2 * poly


def test_shape_is_cut_from_the_naca_thickness_form():
    chord, ratio = jnp.asarray([2.77, 1.61]), jnp.asarray([0.18, 0.13])
    shape = box_shape(chord, ratio, front_spar=0.15, rear_spar=0.62)
    x = np.linspace(0.15, 0.62, 20001)
    for i in range(2):
        half = float(chord[i]) * naca(x, float(ratio[i]))
        assert float(shape.width[i]) == pytest.approx(0.47 * float(chord[i]), rel=1e-12)
        assert float(shape.h_front[i]) == pytest.approx(2 * half[0], rel=1e-12)
        assert float(shape.h_rear[i]) == pytest.approx(2 * half[-1], rel=1e-12)
        assert float(shape.h_mean[i]) == pytest.approx(2 * np.trapezoid(half, x) / 0.47, rel=1e-6)
        assert float(shape.z_square[i]) == pytest.approx(np.trapezoid(half**2, x) / 0.47, rel=1e-6)
        assert float(shape.z_max[i]) == pytest.approx(half.max(), rel=1e-4)
        assert float(shape.z_max[i]) == pytest.approx(float(chord[i] * ratio[i]) / 2, rel=5e-3)


def test_thin_rectangular_box_by_hand():
    t_c, t_w = 0.003, 0.005
    section = section_properties(rectangle(), members(), sheets(t_c, t_c, t_w, t_w))
    assert float(section.area[0]) == pytest.approx(2 * W * t_c + 2 * H * t_w, rel=1e-12)
    assert float(section.inertia[0]) == pytest.approx(2 * W * t_c * H**2 / 4 + 2 * t_w * H**3 / 12, rel=1e-12)
    assert float(section.z_centroid[0]) == 0.0
    bredt = 4 * (W * H) ** 2 / (2 * W / t_c + 2 * H / t_w)
    assert float(section.torsion_constant[0]) == pytest.approx(bredt, rel=1e-12)


def test_unequal_covers_caps_and_stringers_by_parallel_axes():
    cap, stringer, number = 2e-3, 3e-4, 5.0
    section = section_properties(rectangle(), members(cap, stringer, number), sheets(0.005, 0.002, 0.004, 0.003))
    depth, sink = (
        float(z_stringer(jnp.asarray([stringer])).centroid[0]),
        float(cap_depth(jnp.asarray([cap]))[0]),
    )
    parts = [(W * 0.005, H / 2, 0.0), (W * 0.002, -H / 2, 0.0), (H * 0.007, 0.0, 0.007 * H**3 / 12)]
    parts += [(2 * cap, s * (H / 2 - sink), 0.0) for s in (1, -1)]
    parts += [(number * stringer, s * (H / 2 - depth), 0.0) for s in (1, -1)]
    area = sum(a for a, _, _ in parts)
    z_c = sum(a * z for a, z, _ in parts) / area
    inertia = sum(i + a * (z - z_c) ** 2 for a, z, i in parts)
    assert float(section.z_centroid[0]) == pytest.approx(z_c, rel=1e-12)
    assert float(section.inertia[0]) == pytest.approx(inertia, rel=1e-12)
    assert float(jnp.sum(section.upper_moments)) == pytest.approx(
        sum(a * (z - z_c) for a, z, _ in parts if z > 0), rel=1e-12
    )


def boom_model(t, count=1500):
    """Flow for V = 1 in a rectangular closed tube of fine booms, closed by zero twist: (webs' peak, x_sc)."""
    corners = [(0, -H / 2), (0, H / 2), (W, H / 2), (W, -H / 2)]
    points, areas, thick, ds = [], [], [], []
    for k, wall in enumerate([t[2], t[0], t[3], t[1]]):  # front web up, upper aft, rear down, lower forward
        a, b = np.array(corners[k], float), np.array(corners[(k + 1) % 4], float)
        length = np.linalg.norm(b - a)
        middle = (np.arange(count) + 0.5) / count
        points += list(a + (b - a) * middle[:, None])
        areas += [wall * length / count] * count
        thick += [wall] * count
        ds += [(b - a) / count] * count
    points, areas, thick, ds = map(np.array, (points, areas, thick, ds))
    z_c = (areas * points[:, 1]).sum() / areas.sum()
    inertia = (areas * (points[:, 1] - z_c) ** 2).sum()
    step = -areas * (points[:, 1] - z_c) / inertia
    q_open = np.cumsum(step) - 0.5 * step
    length = np.linalg.norm(ds, axis=1)
    q = q_open - (q_open * length / thick).sum() / (length / thick).sum()
    upward = (q * ds[:, 1]).sum()
    nose_up = (q * (points[:, 1] * ds[:, 0] - points[:, 0] * ds[:, 1])).sum()
    web = q[:count], q[2 * count : 3 * count]
    return web[0].max(), web[1].min(), -nose_up / upward, upward


@pytest.mark.parametrize("t", [(0.003, 0.003, 0.004, 0.004), (0.005, 0.002, 0.006, 0.003)])
def test_shear_flow_and_shear_centre_match_a_boom_model(t):
    shape = rectangle()
    section = section_properties(shape, members(), sheets(*t))
    flow = shear_flow(shape, section, sheets(*t))
    front, rear, x_sc, upward = boom_model(t)
    assert upward == pytest.approx(1.0, rel=1e-5)
    np.testing.assert_allclose(flow.web_peak[:, 0], [front, rear], rtol=2e-4)
    assert float(flow.x_shear_centre[0]) == pytest.approx(x_sc, rel=2e-4)
    if t[0] == t[1]:
        assert float(flow.x_shear_centre[0]) == pytest.approx(W / 2, rel=1e-12)


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
    def outputs(p):
        chord, ratio = p[0:1] * 2.5, p[1:2] * 0.17
        shape = box_shape(chord, ratio, front_spar=0.15 * p[2], rear_spar=0.6 * p[3])
        m = box_members(shape, chord, A_cap_root=3e-3 * p[4], A_stringer_root=3e-4 * p[5], pitch=0.15 * p[6])
        t = jnp.asarray([0.005, 0.002, 0.006, 0.004])[:, None] * p[7]
        section = section_properties(shape, m, t)
        flow = shear_flow(shape, section, t)
        parts = (
            section.area * 50,
            section.inertia * 1e3,
            section.torsion_constant * 1e3,
            flow.web_peak[:, 0] / 2,
        )
        return jnp.concatenate([*parts, flow.covers.ravel(), flow.x_shear_centre])

    check_derivatives(outputs, [1.03, 0.98, 1.02, 0.97, 1.05, 1.1, 0.9, 1.04])
