"""The sized box: plausibility, optimality, derivatives, hand sizing, mutations."""

import csv
import tomllib

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from hera_om.core.contours import contour_table
from hera_om.physics import beam_loads, box_section, buckling, wingbox_criteria, wingbox_reserve
from hera_om.physics.beam_loads import (
    inertia_load,
    point_load,
    point_mass,
    section_loads,
    spread_mass,
    strip_load,
)
from hera_om.physics.box_contour import box_shape
from hera_om.physics.wingbox import box_model, evaluate_box, size_box, solve_thickness
from hera_om.physics.wingbox_bought import bought_box, round_up_to_increment
from hera_om.physics.wingbox_criteria import box_state, panel_use
from hera_om.physics.wingbox_types import (
    CRITERIA,
    PANELS,
    BoxConcept,
    BoxGeometry,
    BoxLoads,
    Material,
    box_centre,
    elastic_axis,
    stack_cases,
)

N = 8
G = 9.80665
CONCEPT = BoxConcept(front_spar=0.15, rear_spar=0.62, rib_pitch=0.60, stringer_pitch=0.15, t_min=0.0012)
A_CAP, A_STRINGER = 3.0e-3, 3.5e-4
BASE = jnp.ones(12)


@pytest.fixture(scope="module")
def aircraft(reference):
    return tomllib.loads((reference / "hera_like.toml").read_text())


@pytest.fixture(scope="module")
def material(reference):
    with (reference / "materials.csv").open(newline="") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    row = next(row for row in rows if row["material"].startswith("Al7075-T6"))
    scale = dict(E_GPa=1e9, G_GPa=1e9, nu=1, rho=1, Fty_MPa=1e6, Fcy_MPa=1e6, Ftu_MPa=1e6, Fsu_MPa=1e6)
    return Material(*(float(row[key]) * factor for key, factor in scale.items()))


@pytest.fixture(scope="module")
def wing(aircraft):
    """Planform of the HERA-like aircraft at N stations."""
    data = aircraft["wing"]
    y = jnp.linspace(data["y_fuselage_joint_m"], data["semispan_m"], N)
    breaks = jnp.asarray([0.0, data["y_kink_m"], data["semispan_m"]])
    chord = jnp.interp(y, breaks, jnp.asarray([data[f"chord_{k}_m"] for k in ("root", "kink", "tip")]))
    ratio = jnp.interp(y, breaks, jnp.asarray([data[f"thickness_{k}"] for k in ("root", "kink", "tip")]))
    x = data["x_le_root_m"] + 0.25 * (data["chord_root_m"] - chord)
    return BoxGeometry(jnp.stack([x, y, jnp.full_like(y, data["z_root_m"])], axis=1), chord, ratio)


def flight_case(wing, load_factor, *, fuel=1650.0, pod=8.0, mass=28153.0):
    """Elliptic lift of a half wing at load factor n, relieved by structure, fuel and motors."""
    tip, y = 14.5, wing.leading_edge[:, 1]
    edges = jnp.linspace(0.0, tip, 25)
    middle = 0.5 * (edges[1:] + edges[:-1])
    place = jnp.stack([jnp.full_like(middle, 11.7), middle, jnp.full_like(middle, 1.3)], axis=1)
    shape = jnp.sqrt(1 - (middle / tip) ** 2) * jnp.diff(edges)
    lift = jnp.zeros((24, 3)).at[:, 2].set(load_factor * mass * G / 2 * shape / jnp.sum(shape))
    size = jnp.interp(middle, y, wing.chord**2 * wing.thickness_ratio)
    hubs = jnp.asarray([[9.6, 4.1, 0.95], [10.0, pod, 1.2], [10.0, pod + 2.75, 1.2]])
    thrust = jnp.asarray([[-5600.0, 0, 0], [-1330.0, 0, 0], [-1330.0, 0, 0]])
    tank = jnp.linspace(1.6, 10.0, 13)
    in_tank = 0.5 * (tank[1:] + tank[:-1])
    tank_place = jnp.stack([jnp.full_like(in_tank, 12.1), in_tank, jnp.full_like(in_tank, 1.3)], axis=1)
    masses = (
        spread_mass(1650.0, edges, intensity=size, points=place + jnp.asarray([0.4, 0, 0])),
        spread_mass(fuel, tank, intensity=jnp.interp(in_tank, middle, size), points=tank_place),
        point_mass(jnp.asarray([1075.0, 300.0, 300.0]), hubs + jnp.asarray([0.7, 0, 0])),
    )
    return section_loads(
        y,
        elastic_axis(wing),
        strip_load(edges, place, forces=lift, moments=jnp.zeros((24, 3))),
        point_load(hubs, forces=thrust, moments=jnp.zeros((3, 3))),
        *(inertia_load(item, load_factor) for item in masses),
    )


@pytest.fixture(scope="module")
def full(wing):
    """2.5 g and 1 g with full tanks."""
    return stack_cases(flight_case(wing, 2.5), flight_case(wing, 1.0))


@pytest.fixture(scope="module")
def dry(wing):
    """2.5 g and 1 g at the same mass with empty wing tanks: the critical bending."""
    return stack_cases(flight_case(wing, 2.5, fuel=0.0), flight_case(wing, 1.0, fuel=0.0))


@jax.jit
def _sized(geometry, material, concept, loads, cap, stringer, sharpness):
    return size_box(
        geometry,
        material,
        concept,
        loads=loads,
        A_cap_root=cap,
        A_stringer_root=stringer,
        sharpness=sharpness,
    )


def sized(wing, material, loads, *, cap=A_CAP, stringer=A_STRINGER, concept=CONCEPT, sharpness=200.0):
    """One compiled sizing for the whole module: every number is an argument."""
    return _sized(wing, material, concept, loads, cap, stringer, sharpness)


def all_finite(result):
    return all(bool(jnp.all(jnp.isfinite(leaf))) for leaf in jax.tree.leaves(result))


def test_wing_mass_is_in_the_range_of_published_methods(wing, material, full, aircraft, reference):
    with (reference / "wing_mass_methods.csv").open(newline="") as file:
        published = [
            float(row["wing_mass_kg"])
            for row in csv.DictReader(line for line in file if not line.startswith("#"))
            if row["aircraft"].startswith("ATR")
        ]
    result = sized(wing, material, full)
    total = float(result.m_primary) / aircraft["wing"]["structure"]["primary_fraction"]
    assert min(published) < total < max(published)
    assert float(jnp.sum(jnp.stack(result.mass))) == pytest.approx(float(result.m_primary), rel=1e-12)
    assert 11.5 < float(result.cg[0]) < 12.8 and 4.0 < float(result.cg[1]) < 7.0


def test_every_sheet_is_just_used_up_over_the_whole_box(wing, material, dry):
    for cap in (1e-3, 3e-3, 5e-3):
        for stringer in (1e-4, 3.5e-4, 6e-4):
            result = sized(wing, material, dry, cap=cap, stringer=stringer)
            assert all_finite(result)
            np.testing.assert_allclose(jnp.max(result.worst_excess), 0.0, atol=1e-7)
            # The worst criterion alone reaches one, less the 0.5 % that smoothing may take at ties.
            worst = np.max(np.asarray(result.use), axis=1)
            assert np.all((worst > 0.99) & (worst < 1 + 1e-7)), (cap, stringer, worst)
            assert float(jnp.min(result.t_rib)) >= CONCEPT.t_min


def test_sizing_converges_for_random_loads_and_areas(wing, material, dry):
    random = np.random.default_rng(0)
    for _ in range(60):
        v, m, t = random.uniform(0.3, 1.8, 3)
        loads = dry._replace(V=dry.V * v, M=dry.M * m, T=dry.T * 3 * t)
        areas = {"cap": random.uniform(1e-3, 5e-3), "stringer": random.uniform(1e-4, 6e-4)}
        assert float(jnp.max(jnp.abs(sized(wing, material, loads, **areas).worst_excess))) < 1e-7, (
            v,
            m,
            t,
            areas,
        )


def test_reserve_factors_cross_the_requirement_inside_the_box(wing, material, dry, aircraft):
    bounds = aircraft["design_variables"]
    required = aircraft["mission"]["reserve_factor"]
    low, _, high = bounds["A_cap_root_m2"]
    thin, thick = (sized(wing, material, dry, cap=cap) for cap in (low, high))
    assert float(thin.RFC) < required < float(thick.RFC)
    assert float(thin.RFT) < required < float(thick.RFT)
    low, _, high = bounds["A_stringer_root_m2"]
    thin, thick = (sized(wing, material, dry, stringer=stringer) for stringer in (low, high))
    assert float(thin.RFC) < required < float(thick.RFC)
    assert float(thin.RFT) < float(thick.RFT)


def test_reserves_are_allowable_over_limit_stress(wing, material, dry):
    result = sized(wing, material, dry)
    net = 0.9 * (1.0 - 1.0 / 6.0)  # rows of fasteners six diameters apart, and their notches
    tension = net * material.F_tu / np.max(np.asarray(result.stress), axis=(0, 1, 2))
    np.testing.assert_allclose(result.RFT_span[:-2], tension[:-2], rtol=1e-3)
    assert float(result.RFT) == pytest.approx(tension.min(), rel=1e-2)
    assert float(result.RFT) <= tension.min()
    # Compression is bounded by yield, and the slender stringer is below it.
    yielding = material.F_cy / np.max(-np.asarray(result.stress), axis=(0, 1, 2))
    assert np.all(np.asarray(result.RFC_span)[:-2] < yielding[:-2])
    assert float(result.RF_yield) == pytest.approx(min(yielding.min(), tension.min() / net * 476 / 538), rel=1e-2)


def test_thin_caps_cripple_before_they_yield(wing, material, dry, monkeypatch):
    """A flange 4 t wide yields first; one 12 t wide cripples at 0.316 sqrt(469 x 71700) / 12^0.75 = 284 MPa."""
    model = box_model(wing, material, CONCEPT, loads=dry, A_cap_root=A_CAP, A_stringer_root=A_STRINGER)
    t = solve_thickness(model)
    model = model._replace(concept=model.concept._replace(rib_pitch=0.2))  # the column is out of the way
    centre = box_centre(wing, CONCEPT)
    monkeypatch.setattr(wingbox_reserve, "column_stress", lambda model, t: jnp.full((2, N), 1e9))
    stocky = evaluate_box(model, centre, t)
    pressed = np.max(-np.asarray(stocky.stress)[:2])
    assert float(stocky.RFC) == pytest.approx(469e6 / pressed, rel=2e-2)
    monkeypatch.setattr(box_section, "CAP_ASPECT", 12.0)
    thin = evaluate_box(model, centre, t)
    pressed = np.max(-np.asarray(thin.stress)[:2])
    assert float(thin.RFC) == pytest.approx(284.2e6 / pressed, rel=2e-2)


def test_torsion_alone_sizes_as_shear_buckling_by_hand(wing, material):
    """t = (1.5 q b^2 / (k C))^(1/3), q = T / (2 A): no bending, no shear."""
    torque, none = jnp.full((1, N), 1.0e5), jnp.zeros((1, N))
    result = sized(wing, material, BoxLoads(none, none, torque, none, none))
    shape = box_shape(wing.chord, wing.thickness_ratio, front_spar=0.15, rear_spar=0.62)
    q = 1.0e5 / (2 * np.asarray(shape.enclosed))
    plate = np.pi**2 * material.E / (12 * (1 - material.nu**2))
    skin = np.cbrt(1.5 * q * 0.15**2 / ((5.34 + 4 / 16) * plate))
    height = np.asarray(shape.h_front)
    web = np.cbrt(1.5 * q * height**2 / ((5.34 + 4 * (height / 0.6) ** 2) * plate))
    np.testing.assert_allclose(result.t_skin_upper, skin, rtol=4e-3)  # four equal points: 4^(1/200), its cube root
    np.testing.assert_allclose(result.t_skin_lower, skin, rtol=4e-3)
    np.testing.assert_allclose(result.t_web_front, web, rtol=3e-3)
    assert [CRITERIA[i] for i in np.unique(result.active)] == ["buckling"]


def test_ribs_carry_the_crushing_load_by_hand(wing, material, dry):
    result = sized(wing, material, dry)
    shape = box_shape(wing.chord, wing.thickness_ratio, front_spar=0.15, rear_spar=0.62)
    width, height = float(shape.width[0]), float(shape.h_mean[0])
    stringers = (width / 0.15 - 1) * A_STRINGER / float(shape.arc[0, 0])
    sheets = float(result.t_skin_upper[0]), float(result.t_skin_lower[0])
    stress = np.max(np.abs(np.asarray(result.stress)[:2, :, 0, 0]), axis=1)
    crushing = max(s**2 * (t + stringers) for s, t in zip(stress, sheets, strict=True))
    load = 2 * crushing / (material.E * height) * 0.60
    k = (height / width + width / height) ** 2
    plate = k * np.pi**2 * material.E / (12 * (1 - material.nu**2)) / width**2
    # The factor 1.5 on the load is its square on what crushes.
    assert float(result.t_rib[0]) == pytest.approx(np.cbrt(1.5**2 * load / plate), rel=5e-3)
    assert float(result.t_rib[0]) > 2 * CONCEPT.t_min


def test_thin_skins_between_wide_stringers_are_sized_by_crushing(wing, material, dry):
    """s_b = p b^2 / (2 t^2) = F_cy / 1.5^2, p = 2 s^2 t_e / (E h): by hand from the stress found."""
    bent = BoxLoads(*(dry.M if name == "M" else 0.0 * dry.M for name in BoxLoads._fields))
    result = sized(wing, material._replace(F_cy=100e6), bent, concept=CONCEPT._replace(t_min=1e-4))
    shape = box_shape(wing.chord, wing.thickness_ratio, front_spar=0.15, rear_spar=0.62)
    crushed = np.asarray(result.active[1]) == CRITERIA.index("crushing")
    assert np.sum(crushed) > 1
    stringers = (shape.width / 0.15 - 1) * A_STRINGER * (shape.h_mean * wing.chord) / (shape.h_mean * wing.chord)[0]
    t = np.asarray(result.t_skin_lower)
    stress = np.max(np.abs(np.asarray(result.stress)[1]), axis=(0, 1))
    pressure = 2 * stress**2 * (t + stringers / shape.arc[1]) / (material.E * shape.h_mean)
    found = np.asarray(1.5**2 * pressure * (0.15 / t) ** 2 / 2 / 100e6)
    np.testing.assert_allclose(found[crushed], 1.0, atol=0.03)  # squares of utilisations that share at ties


def _worst(model, t):
    """True maximum utilisation of every panel, no smoothing."""
    return jnp.max(jnp.stack([jnp.max(u, axis=(0, 1, 2)) for u in panel_use(model, box_state(model, t), t)]), axis=0)


def random_bays(material, count=10):
    """Boxes of random airfoil, size and loads in three cases, one a station."""
    random = np.random.default_rng(5)
    chord, ratio = jnp.asarray(random.uniform(1.5, 3.5, count)), jnp.asarray(random.uniform(0.11, 0.20, count))
    names = random.choice(["NACA 43018", "NACA 2412", "NACA 4415", "NACA 23013"], count)
    tables = jnp.asarray(np.stack([contour_table(name) for name in names]))
    edge = jnp.stack([0.0 * chord, jnp.arange(count) * 1.0, 0.0 * chord], axis=1)
    size = np.asarray(chord**2 * ratio)
    cases = {"V": 1.2e5, "M": 5.0e5, "T": 3.0e4, "H": 1.0e4, "Mz": 5.0e4}
    sign = np.array([[1.0], [0.9], [-0.5]])
    loads = {k: jnp.asarray(v * sign * np.exp(random.uniform(-4.0, 1.8, (3, count))) * size) for k, v in cases.items()}
    geometry = BoxGeometry(edge, chord, ratio, tables=tables)
    return box_model(geometry, material, CONCEPT, loads=BoxLoads(**loads), A_cap_root=A_CAP, A_stringer_root=A_STRINGER)


def test_brute_force_finds_nothing_lighter_in_ten_random_bays(material):
    """All thicknesses within 5 % on a grid and by chance, no smoothing: nothing feasible is lighter by 0.1 %."""
    count, model = 10, random_bays(material)
    best = solve_thickness(model)
    sides = np.stack(np.meshgrid(*[np.linspace(-0.05, 0.05, 9)] * 4)).reshape(4, -1)
    near = np.random.default_rng(6).uniform(-0.01, 0.01, (4, 6000))
    offsets = jnp.asarray(np.concatenate([np.zeros((4, 1)), sides, near], axis=1))
    trials = offsets.shape[1]

    @jax.jit
    def search(station):
        def repeat(leaf):
            leaf = jnp.asarray(leaf)
            several = leaf.ndim and leaf.shape[-1] == count
            return jnp.repeat(leaf[..., station][..., None], trials, axis=-1) if several else leaf

        many = jax.tree.map(repeat, model)
        t = best[:, station][:, None] * (1 + offsets)
        shape = many.shape
        return _worst(many, t), shape.arc[0] * t[0] + shape.arc[1] * t[1] + shape.h_front * t[2] + shape.h_rear * t[3]

    governing = set()
    for station in range(count):
        worst, area = search(station)
        assert float(worst[0]) <= 1 + 1e-9
        lightest = float(jnp.min(jnp.where(worst <= 1.0, area, jnp.inf)))
        assert lightest > (1 - 0.001) * float(area[0]), station
        assert float(jnp.min(area)) < 0.96 * float(area[0])  # the search does see lighter ones
        used = [jnp.max(u, axis=(1, 2))[:, station] for u in panel_use(model, box_state(model, best), best)]
        governing |= set(np.argmax(np.stack(used), axis=0).tolist())
    assert {CRITERIA[i] for i in governing} >= {"von Mises", "buckling"}


def test_partials_at_the_edge_between_two_criteria(wing, material, dry):
    """Minimum gauge put where buckling sizes the lower skin just as thick: both share, and derivatives stay exact."""
    free = sized(wing, material, dry)
    edge = float(free.t_skin_lower[4])

    def run(p):
        found = _sized(
            wing, material, CONCEPT._replace(t_min=edge * p[0]), dry._replace(T=dry.T * p[1]), A_CAP, A_STRINGER, 200.0
        )
        return jnp.concatenate([found.t_skin_lower * 500.0, found.m_primary[None] / 1e3])

    point = np.ones(2)
    both = np.asarray(sized(wing, material, dry, concept=CONCEPT._replace(t_min=edge)).use)[1, :, 4]
    assert np.sum(both > 0.99) == 2  # two criteria are active
    exact, h = np.asarray(jax.jacfwd(run)(point)), 1e-4

    def central(step):
        return np.stack(
            [(np.asarray(run(point + step * e)) - run(point - step * e)) / (2 * step) for e in np.eye(2)], -1
        )

    np.testing.assert_allclose(exact, (4 * central(h / 2) - central(h)) / 3, atol=1e-6 * np.max(np.abs(exact)))
    assert np.all(np.abs(exact[4]) > 0.01)  # each of the two moves the sheet


def scaled(p, wing, material, loads):
    """Outputs of order one of a box whose twelve inputs are scaled by p."""
    geometry = BoxGeometry(wing.leading_edge, wing.chord * p[0], wing.thickness_ratio * p[1], 0.38 * p[2])
    concept = BoxConcept(0.15 * p[3], 0.62 * p[4], 0.6 * p[5], 0.15 * p[6], 0.0012 * p[7])
    cases = loads._replace(V=loads.V * p[8], M=loads.M * p[9])
    result = size_box(
        geometry, material, concept, loads=cases, A_cap_root=A_CAP * p[10], A_stringer_root=A_STRINGER * p[11]
    )
    sheets = [result.t_skin_upper, result.t_skin_lower, result.t_web_front, result.t_web_rear, result.t_rib]
    totals = jnp.stack([result.m_primary / 1e3, result.RFT, result.RFC, result.cg[1] / 5.0])
    return jnp.concatenate([totals, jnp.concatenate(sheets) * 200.0])


@pytest.fixture(scope="module")
def scaled_box(wing, material, dry):
    return lambda p: scaled(p, wing, material, dry)


POINT = np.asarray([1.0, 1.02, 0.97, 1.05, 0.98, 1.03, 0.96, 1.01, 1.04, 0.99, 0.85, 1.1])


def test_derivatives_by_twelve_inputs(scaled_box):
    run, jacobian = jax.jit(scaled_box), jax.jit(jax.jacfwd(scaled_box))
    exact = np.asarray(jacobian(POINT))
    h = 2e-4

    def central(function, step):
        return (np.asarray(function(POINT + step)) - np.asarray(function(POINT - step))) / 2

    def columns(function):
        steps = h * np.eye(12)
        return np.stack([(4 * central(function, s / 2) * 2 - central(function, s)) / (3 * h) for s in steps], -1)

    np.testing.assert_allclose(exact, columns(run), atol=1e-6 * np.max(np.abs(exact)))
    # Second derivatives of the mass and the reserve factors along one direction, nested forward mode.
    direction = np.linspace(-1.0, 1.0, 12)

    def slope(p):
        return jax.jvp(scaled_box, (p,), (jnp.asarray(direction),))[1]

    second = np.asarray(jax.jit(lambda p: jax.jvp(slope, (p,), (jnp.asarray(direction),))[1])(jnp.asarray(POINT)))
    step = h * direction
    along = (4 * central(jacobian, step / 2) * 2 - central(jacobian, step)) / (3 * h) @ direction
    np.testing.assert_allclose(second[:4], along[:4], atol=1e-5 * np.max(np.abs(along)))
    mass_row = jax.jit(jax.grad(lambda p: scaled_box(p)[0]))(jnp.asarray(POINT))
    np.testing.assert_allclose(mass_row, exact[0], atol=1e-10 * np.max(np.abs(exact)))


def test_relief_load_factor_and_engine_position(wing, material, full, monkeypatch):
    base = float(sized(wing, material, full).m_primary)
    halved = stack_cases(flight_case(wing, 1.25), flight_case(wing, 1.0))
    assert float(sized(wing, material, halved).m_primary) < 0.93 * base
    outboard = stack_cases(flight_case(wing, 2.5, pod=10.2), flight_case(wing, 1.0, pod=10.2))
    assert float(sized(wing, material, outboard).m_primary) < base - 1.0
    monkeypatch.setattr(beam_loads, "inertia_forces", lambda mass, n: jnp.zeros((mass.size, 3)))
    bare = stack_cases(flight_case(wing, 2.5), flight_case(wing, 1.0))
    assert float(sized(wing, material, bare).m_primary) > 1.04 * base


def test_smoothing_costs_less_than_a_kilogram(wing, material, dry):
    """0.1 kg of 2 t: the p-norm of exponent 200 against that of 5000."""
    smooth, sharp = (sized(wing, material, dry, sharpness=p) for p in (200.0, 5000.0))
    error = float(smooth.m_primary - sharp.m_primary)
    assert 0.0 < error < 0.3
    assert float(smooth.RFC) == pytest.approx(float(sharp.RFC), rel=5e-3)
    assert float(smooth.RFT) == pytest.approx(float(sharp.RFT), rel=5e-3)


def test_a_load_that_no_sheet_carries_is_named(wing, material, dry):
    torque = dry.T.at[:, 2].set(3e8)
    result = sized(wing, material, dry._replace(T=torque))
    assert all_finite(result)
    assert int(jnp.argmax(result.worst_excess)) == 2
    assert float(result.worst_excess[2]) > 0.5
    np.testing.assert_allclose(np.delete(np.asarray(result.worst_excess), 2), 0.0, atol=1e-7)
    panel, criterion = np.unravel_index(int(jnp.argmax(result.use[:, :, 2])), (4, 4))
    assert (PANELS[panel], CRITERIA[criterion]) != ("upper skin", "minimum gauge")
    assert float(jnp.max(result.use[:, 3, 2])) < 1.0


def test_bending_beyond_the_caps_is_reported_not_repaired(wing, material, dry):
    double = dry._replace(M=2.0 * dry.M)
    result = sized(wing, material, double, cap=1e-3)
    assert float(jnp.max(result.worst_excess)) < 1e-7
    assert float(result.RFT) < 1.0 and float(result.RFC) < 1.0


def test_rounding_only_adds_and_limits_the_steps():
    t = jnp.asarray([[0.00512, 0.00401, 0.00231, 0.00122]])
    free = round_up_to_increment(t, increment=1e-4)
    np.testing.assert_allclose(free, [[0.0052, 0.0041, 0.0024, 0.0013]], atol=1e-12)
    bought = round_up_to_increment(t, increment=1e-4, max_step=8e-4)
    np.testing.assert_allclose(bought, [[0.0052, 0.0044, 0.0036, 0.0028]], atol=1e-12)


@pytest.mark.parametrize("max_step", [3e-4, 1.0])
def test_what_can_be_bought_has_no_lower_reserve_anywhere(wing, material, dry, max_step):
    model = box_model(wing, material, CONCEPT, loads=dry, A_cap_root=A_CAP, A_stringer_root=A_STRINGER)
    centre = box_centre(wing, CONCEPT)
    found = _smooth_and_bought(model, centre, max_step)
    smooth, real = found
    sheets = [np.stack([b.t_skin_upper, b.t_skin_lower, b.t_web_front, b.t_web_rear, b.t_rib]) for b in (smooth, real)]
    assert np.all(sheets[1] >= sheets[0] - 1e-12)
    np.testing.assert_allclose(sheets[1] / 1e-4, np.round(sheets[1] / 1e-4), atol=1e-6)
    assert np.max(np.abs(np.diff(sheets[1][:4], axis=1))) <= max_step * (1 + 1e-9)
    assert float(jnp.max(real.worst_excess)) < 1e-6
    for name in ("RFC_span", "RFT_span"):
        before, after = (np.minimum(getattr(b, name), 10.0) for b in (smooth, real))
        assert np.all(after > before * (1 - 2e-6))
    assert 0.0 < float(real.m_primary - smooth.m_primary) < 0.15 * float(smooth.m_primary)


def test_no_random_wing_that_is_bought_has_a_lower_reserve(wing, material):
    """Slender stringers and stout caps among them, where thicker skin loads the stringers with more of itself."""
    cases = [flight_case(wing, n, fuel=fuel) for n, fuel in ((2.5, 0.0), (2.5, 1650.0), (-1.0, 1650.0), (1.0, 0.0))]
    loads, centre, random = stack_cases(*cases), box_centre(wing, CONCEPT), np.random.default_rng(0)
    for _ in range(15):
        cap, stringer = random.uniform(1e-3, 5e-3), random.uniform(1e-4, 6e-4)
        v, m, t = random.uniform(0.3, 1.8, 3)
        increment, max_step = random.choice([1e-4, 2e-4, 5e-4]), random.choice([5e-4, 1e-3, 1.0])
        some = loads._replace(V=loads.V * v, M=loads.M * m, T=loads.T * 3 * t)
        model = box_model(wing, material, CONCEPT, loads=some, A_cap_root=cap, A_stringer_root=stringer)
        smooth, real = _smooth_and_bought(model, centre, max_step, increment)
        assert float(jnp.max(real.worst_excess)) < 1e-6
        for name, enough in (("RFC", max(1.5, 1.05 * float(smooth.RFC))), ("RFT", 10.0)):
            before, after = (np.minimum(getattr(b, f"{name}_span"), enough) for b in (smooth, real))
            assert np.all(after > before * (1 - 2e-6)), (name, cap, stringer, increment, max_step)
            assert float(getattr(real, name)) > (1 - 2e-6) * float(getattr(smooth, name))


@jax.jit
def _smooth_and_bought(model, centre, max_step, increment=1e-4):
    smooth = evaluate_box(model, centre, solve_thickness(model))
    return smooth, bought_box(model, centre, smooth, increment=increment, max_step=max_step)


MUTATIONS = {
    "skin buckling off": (wingbox_criteria, "cover_buckling_use", 0.94),
    "web buckling off": (wingbox_criteria, "web_buckling_use", 0.97),
    "Brazier crushing off": (buckling, "brazier_pressure", 0.99),
}


@pytest.mark.parametrize("name", MUTATIONS)
def test_each_criterion_carries_weight(name, wing, material, dry, monkeypatch):
    """Without it the box is lighter by more than the stated share: the criterion is alive."""
    module, function, share = MUTATIONS[name]
    base = float(sized(wing, material, dry).m_primary)
    original = getattr(module, function)
    monkeypatch.setattr(module, function, lambda *args, **kw: 0.0 * original(*args, **kw))
    model = box_model(wing, material, CONCEPT, loads=dry, A_cap_root=A_CAP, A_stringer_root=A_STRINGER)
    fresh = jax.jit(lambda m: evaluate_box(m, box_centre(wing, CONCEPT), solve_thickness(m)).m_primary)
    assert float(fresh(model)) < share * base
