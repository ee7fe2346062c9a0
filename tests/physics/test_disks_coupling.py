"""Rotors in the flow of the surfaces and back: axes, mirror images, equilibrium, derivatives through it."""

from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from hera_om.physics import coupling
from hera_om.physics.aero_cases import Flow, Model, RotorPlan, Rotors, Slender, StripPolar, Surface
from hera_om.physics.coupling import (
    Controls,
    Setting,
    join_factors,
    make_system,
    onset,
    respond,
    split_factors,
    unknowns,
)
from hera_om.physics.disks import Wake, blades, disk_points, rotor_loads, shaft_axes, slipstreams, wake_behind
from hera_om.physics.equilibrium import as_vector, carried, find_root, linearised, settle
from hera_om.physics.finite_jet import reflection
from hera_om.physics.fuselage import Fuselage
from hera_om.physics.geometry import Sections, make_grid
from hera_om.physics.layout import ROOTED
from hera_om.physics.nacelle import held_up
from hera_om.physics.rotor import sense_sign
from hera_om.physics.section_polar import SectionPolar
from hera_om.physics.slipstream import disk_mean

PLAN = RotorPlan(groups=(0,), sides=2, radial=4, azimuthal=4, tip_loss=True, hub_loss=True)
SINGLE = PLAN._replace(sides=1)
TABLE = ([0.2, 0.5, 1.0], [0.13, 0.15, 0.06], np.radians([28.0, 11.0, -8.0]))
PITCH = np.radians(34.0)
MODEL = Model((ROOTED,))


def rotor(y=3.0, incidence=0.1):
    one = jnp.ones(1)
    polar = SectionPolar(*[v * one for v in (6.0, -0.05, 0.008, 0.3, 0.010, 1.4, 1.0)])
    tables = [jnp.asarray(v)[None] for v in TABLE]
    sense = sense_sign("inboard-up", 1.0) * one
    hub = jnp.array([[-1.6, y, 0.2]])
    return Rotors(hub, incidence * one, 1.5 * one, 0.3 * one, 0.0 * one, *tables, polar, 6.0 * one, 130.0 * one, sense)


def flow():
    values = [jnp.asarray(v, float) for v in (90.0, 1.0, 330.0, 1.7e-5, 0.27)]
    return Flow(*values, jnp.array([0.5, 0.0, 0.1]))


def surfaces():
    wing = Sections(*[jnp.asarray(v) for v in ([0.0, 0.3], [0.0, 8.0], [0.0, 0.2], [2.4, 2.0], [0.0, 0.0])])
    grid = make_grid([0.0, 8.0], ["NACA 2412"] * 2, nc=1, ns=6, span="uniform", chord="uniform")
    return [Surface(wing, grid, StripPolar(0.006, 0.2, 0.006, 1e7, 1.6), wing.y)]


def state(alpha=0.06, q_hat=0.0, pitch=PITCH):
    return Controls(jnp.asarray(alpha), jnp.asarray(q_hat), jnp.zeros(0), jnp.asarray([pitch]), jnp.zeros(0))


@jax.jit
def setting():
    return Setting(make_system(surfaces(), rotor(), PLAN, flow().mach, MODEL), rotor(), flow(), 2.2, 16.0)


@jax.jit
def root_at(x, at):
    return find_root(x, at, PLAN)


@jax.jit
def answer_at(flat, x, at, phi):
    return respond(flat, x, at, PLAN, phi)


@pytest.fixture(scope="module")
def at():
    return setting()


@pytest.fixture(scope="module")
def root(at):
    return root_at(state(), at)


def test_a_tilted_shaft_lifts():
    """Rows are unit vectors along the shaft, aft, starboard and up; incidence tilts the thrust up."""
    axes = np.asarray(shaft_axes(jnp.array([0.3])))[0]
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-15)
    assert np.linalg.det(axes) == pytest.approx(1.0)
    assert (-axes[0])[2] == pytest.approx(np.sin(0.3))


def test_points_of_the_disk_lie_in_its_plane_at_their_radii():
    points = np.asarray(disk_points(rotor(), PLAN))[0] - np.array([-1.6, 3.0, 0.2])
    np.testing.assert_allclose(points @ np.asarray(shaft_axes(jnp.array([0.1])))[0, 0], 0.0, atol=1e-14)
    radii = np.asarray(blades(rotor(), PLAN).r)[0]
    np.testing.assert_allclose(np.linalg.norm(points, axis=-1), np.repeat(radii[:, None], 4, axis=1), rtol=1e-12)


def test_loads_of_a_tilted_rotor_are_those_of_an_upright_one_turned():
    """A stream along the tilted shaft makes thrust and torque along it."""
    axes = shaft_axes(jnp.array([0.1]))[0]
    velocity = jnp.broadcast_to(90.0 * axes[0], (1, 1, 4, 4, 3))
    load = jax.jit(lambda v: rotor_loads(rotor(), PLAN, v, pitch=jnp.array([PITCH]), flow=flow()))(velocity)
    np.testing.assert_allclose(load.force[0, 0] / load.thrust[0, 0], -axes[0], atol=1e-10)
    np.testing.assert_allclose(
        load.moment[0, 0] / load.torque[0, 0], axes[0], atol=1e-10
    )  # inboard-up turns negatively


def before_a_nacelle(radius, speed=90.0, plan=PLAN):
    """The rotor before a nacelle in a stream along its shaft; every half has its own speed."""
    speeds = jnp.atleast_1d(jnp.asarray(speed))[:, None, None, None, None]
    velocity = speeds * jnp.broadcast_to(shaft_axes(jnp.array([0.1]))[0, 0], (1, 1, 4, 4, 3))
    disk = rotor()._replace(nacelle_radius=radius)
    return rotor_loads(disk, plan, velocity, pitch=jnp.array([PITCH]), flow=flow())


def test_a_nacelle_slows_its_own_disk_and_pays_for_it(check_derivatives):
    """More thrust and torque in slower air; the force lacks the drag of the nacelle. At rest it does neither."""
    run = jax.jit(before_a_nacelle)
    plain, load = run(jnp.array([0.0])), run(jnp.array([0.6]))
    assert load.thrust > 1.01 * plain.thrust and load.torque > plain.torque
    blade = jax.tree.map(lambda v: v[0], blades(rotor(), PLAN))
    slow = held_up(blade.r, hub_radius=0.3, nacelle_radius=0.6, beta=np.sqrt(1.0 - 0.27**2))
    annuli, v = 6.0 * jnp.mean(load.blade_thrust[0, 0], axis=1) * blade.dr, load.v_axial[0, 0]
    force = jnp.sum(annuli * (1.0 - slow * 90.0 / (90.0 + v)))
    np.testing.assert_allclose(jnp.linalg.norm(load.force), force, rtol=1e-12)
    check_derivatives(lambda radius: run(radius).force[0, 0], np.array([0.6]))
    still, bare = (run(jnp.array([r]), 0.0) for r in (0.6, 0.0))
    np.testing.assert_allclose(still.force, bare.force, rtol=1e-12)


def test_nacelles_of_two_halves_of_which_one_has_failed():
    """Each half is as it is alone, in its own stream."""
    radius = jnp.array([0.6])
    both = before_a_nacelle(radius, [90.0, 80.0], PLAN._replace(failed=((1, 0, "stopped"),)))
    runs = before_a_nacelle(radius, 90.0)
    stopped = before_a_nacelle(radius, 80.0, PLAN._replace(failed=((0, 0, "stopped"),)))
    for half, alone in enumerate((runs, stopped)):
        np.testing.assert_allclose(both.force[half], alone.force[0], rtol=1e-9)
    assert stopped.thrust[0, 0] < 0.0 < runs.thrust[0, 0]


def test_the_mirrored_rotor_blows_the_mirrored_way():
    """With rotors on either side the field is a mirror image of itself and the sum of both."""
    wake = Wake(jnp.full((1, 1, 4), 0.1), jnp.full((1, 1, 4), 0.05), jnp.zeros((1, 1, 2)))
    p = jnp.array([[0.5, 2.4, 0.3], [0.5, 3.5, 0.1], [2.0, 0.2, 0.0]])
    mirror = jnp.array([1.0, -1.0, 1.0])
    every, winds = jax.jit(slipstreams, static_argnums=1), jnp.array([[1.0, 0.0, 0.0]])

    def field(*args):
        return jnp.sum(every(*args, winds=winds)[0], axis=0)

    both, other = field(rotor(), PLAN, wake, p), field(rotor(), PLAN, wake, p * mirror)
    np.testing.assert_allclose(other, both * mirror, atol=1e-15)
    alone, image = field(rotor(), SINGLE, wake, p), field(rotor(), SINGLE, wake, p * mirror) * mirror
    np.testing.assert_allclose(both, alone + image, atol=1e-15)
    # inboard-up: up inboard of the hub, down outboard
    assert both[0, 2] > 0.01 and both[1, 2] < -0.01 and both[0, 0] > 0.05


def test_onset_of_a_pitch_rate_by_hand():
    """Nose up about the point: a tail 10 m behind it goes down, so its air goes up by 2 q_hat 10 / c."""
    point = jnp.array([1.0, 0.0, 0.0])
    at = Setting(make_system([], None, None, 0.0, MODEL), None, flow()._replace(point=point), 2.0, 10.0)
    air = onset(jnp.array([11.0, 2.0, 3.0]), state(alpha=0.1, q_hat=0.02), at)
    np.testing.assert_allclose(air, [np.cos(0.1) - 0.06, 0.0, np.sin(0.1) + 0.2], rtol=1e-12)


def test_equilibrium(at, root):
    answer = answer_at(root.flat, state(), at, root.phi)
    assert float(jnp.max(jnp.abs(answer.flat - root.flat))) < 1e-12
    assert root.flat.shape == (unknowns(PLAN, at.system, state()),) == (10,)
    assert np.all(np.asarray(root.flat)[:4] > 0.01)


def test_upwash_of_the_wing_loads_the_disk(at, root, monkeypatch):
    """Ahead of a lifting wing the air rises, more than without: the side force of an inclined disk grows."""
    with_it = answer_at(root.flat, state(), at, root.phi).loads
    monkeypatch.setattr(coupling, "UPWASH", 0.0)
    without = jax.jit(lambda f, x, a: respond(f, x, a, PLAN))(root.flat, state(), at).loads
    up = np.asarray(shaft_axes(jnp.array([0.1])))[0, 2]
    assert float(with_it.force[0, 0] @ up) > float(without.force[0, 0] @ up) + 100.0


@pytest.mark.parametrize("side", [1.0, -1.0])
def test_upwash_of_a_slender_fuselage_at_the_disk(monkeypatch, side):
    """Beside a round body of radius a: w a^2 (y^2 - z^2) / r^4 upwards and -2 w a^2 y z / r^4 outwards, w = alpha;
    the same turned with sideslip (doublet of a cylinder in crossflow).
    """
    shape, alpha, beta = Fuselage(30.0, 2.0, 2.0, 3.0, 6.0), 0.06, 0.02
    body = Slender(shape, (jnp.asarray(8.0), jnp.asarray(10.4)), jnp.asarray(28.0))
    one = rotor(incidence=0.0)._replace(hub=jnp.array([[12.0, 3.0, 0.2]]))
    system = make_system(surfaces(), one, PLAN, flow().mach, MODEL, body)
    at = Setting(system, one, flow(), 2.2, 16.0)
    x = state(alpha)._replace(lateral=jnp.array([beta, 0.0, 0.0]))
    points = disk_points(one, PLAN)
    y, z = np.asarray(points[..., 1]), np.asarray(points[..., 2])
    w, v, r4 = alpha, -side * beta, (y**2 + z**2) ** 2
    along, across = (y**2 - z**2) / r4, 2.0 * y * z / r4
    expected = np.stack([0.0 * y, -w * across - v * along, w * along - v * across], axis=-1)
    np.testing.assert_allclose(coupling._body_upwash(points, at, x, side), expected, atol=1e-15)
    seen = []
    monkeypatch.setattr(coupling, "rotor_loads", lambda *args, **how: seen.append(args[2]) or rotor_loads(*args, **how))
    plain = at._replace(system=system._replace(slender=None))
    for setting_ in (at, plain):
        coupling._disk_loads(one, setting_, state(alpha), jnp.zeros((1, 6)), None, plan=PLAN, phi=None)
    mirrored = np.stack([0.0 * y, -w * across, w * along], axis=-1)
    np.testing.assert_allclose(seen[0] - seen[1], flow().speed * mirrored[None], atol=1e-10)


def test_the_slipstream_of_the_root_blows_the_wing(at, root):
    """Circulation of the strips abreast of the disk against that without any wake."""
    blown = answer_at(root.flat, state(), at, root.phi).gamma
    plain = answer_at(jnp.zeros(10), state(), at, root.phi).gamma
    gain = np.asarray(blown / plain)[0]
    assert gain[1] > 1.1 and gain[5] < 1.05  # strips of 1.33 m, the hub at 3 m; the sixth is at 7.3 m


def test_derivatives_are_carried_through_the_root(at, root):
    """One Newton step: values, and derivatives by incidence, pitch, density and speed; of the derivatives themselves
    too."""

    known = jax.jit(lambda x: settle(root, x, at, PLAN)[1])(state())

    @partial(jax.jit, static_argnames="how")
    def moved(v, how):
        x = state(v[0], 0.0, v[1])
        there = at._replace(flow=at.flow._replace(density=v[2], speed=v[3]))
        if how:
            found = carried(known, x, there, PLAN)
        else:
            found = settle(find_root(x, there, PLAN), x, there, PLAN)[0]
        return jnp.concatenate([found.answer.flat, found.by.flat.ravel(), found.by.gamma.ravel()])

    base, size = np.array([0.06, PITCH, 1.0, 90.0]), np.array([1e-4, 1e-4, 1e-3, 1e-2])
    np.testing.assert_allclose(moved(base, True), moved(base, False), atol=1e-12)
    found = np.asarray(jax.jit(jax.jacfwd(lambda v: moved(v, True)))(jnp.asarray(base)))
    for i in range(4):
        steps = [np.where(np.arange(4) == i, h * size, 0.0) for h in (2.0, 1.0)]
        wide, narrow = ((moved(base + d, False) - moved(base - d, False)) / (2 * d[i]) for d in steps)
        expected = np.asarray((4 * narrow - wide) / 3)
        scale = max(np.max(np.abs(expected)) * size[i], 1e-4)
        np.testing.assert_allclose(found[:, i] * size[i], expected * size[i], rtol=0, atol=1e-6 * scale)


def test_one_pass_serves_the_same_unknown_of_all_rotors():
    """Derivatives of the answer against plain differentiation: lateral flow, jets that overlap, a rotor in another."""
    plan, model = TANDEM._replace(radial=3), MODEL._replace(lateral=True)
    one = rotor()
    pair = jax.tree.map(lambda v: jnp.concatenate([v, v]), one)
    pair = pair._replace(hub=jnp.array([[-3.0, 2.6, 0.0], [-1.6, 3.2, 0.1]]))
    x = Controls(*[jnp.asarray(v) for v in (0.05, 0.01, np.zeros(0), [PITCH, PITCH + 0.02], [0.04, 0.01, -0.02])])

    @jax.jit
    def both():
        at = Setting(make_system(surfaces(), pair, plan, flow().mach, model), pair, flow(), 2.2, 16.0)
        root = find_root(x, at, plan)
        first, unpack = as_vector(x)
        n = root.flat.shape[0]
        state = jnp.concatenate([root.flat, first])
        plain = jax.jacfwd(lambda v: respond(v[:n], unpack(v[n:]), at, plan, root.phi))(state)
        return plain, linearised(root, x, at, plan)[1]

    plain, found = both()
    assert found.flat.shape == (32, 32 + 7)
    for name in ("flat", "gamma", "wake", "loads"):
        pairs = zip(jax.tree.leaves(getattr(plain, name)), jax.tree.leaves(getattr(found, name)), strict=True)
        for expected, value in pairs:
            np.testing.assert_allclose(value, expected, rtol=0, atol=1e-11 * max(1.0, np.max(np.abs(expected))))


def test_factors_come_apart_and_together(at):
    bare, factors = split_factors(at.system)
    assert bare.lattice.even.lu == () and factors[1:] == (None, None)
    again = join_factors(bare, factors)
    assert all(a is b for a, b in zip(again.lattice.even.lu, at.system.lattice.even.lu, strict=True))
    nothing = make_system([], None, None, 0.0, MODEL)
    assert split_factors(nothing) == (nothing, ()) and join_factors(nothing, ()) is nothing


def test_a_rotor_alone_and_a_wing_alone_need_no_iteration(at):
    alone, plan = (
        Setting(make_system([], rotor(), PLAN, 0.0, MODEL), rotor(), flow(), 2.2, 16.0),
        PLAN._replace(neighbours=False),
    )
    found = jax.jit(lambda x: respond(jnp.zeros(0), x, alone, plan))(state())
    assert unknowns(plan, alone.system, state()) == 0 and unknowns(None, at.system, state()) == 0
    np.testing.assert_allclose(found.wake.axial, found.loads.v_axial / 90.0, rtol=1e-12)
    root = find_root(state(), at, None)
    assert root.flat.shape == (0,) and root.phi is None


# --- one rotor behind another

FRONT, REAR = -7.0, -1.0
TANDEM = PLAN._replace(groups=(0, 1), radial=8, azimuthal=4)


def coaxial():
    """Two rotors, the second one behind the first."""
    pair = jax.tree.map(lambda v: jnp.concatenate([v, v]), rotor(incidence=0.0))
    return pair._replace(hub=jnp.array([[FRONT, 3.0, 0.0], [REAR, 3.0, 0.0]]))


@pytest.fixture(scope="module")
def tandem():
    """Loads of two coaxial rotors ahead of a wing at no incidence, the rear one turning one way or the other."""
    pair = coaxial()

    @partial(jax.jit, static_argnums=2)
    def solve(pitch, sense, wing):
        rotors = pair._replace(sense=pair.sense * jnp.stack([jnp.ones(()), sense]))
        system = make_system(surfaces() if wing else [], rotors, TANDEM, flow().mach, MODEL)
        at = Setting(system, rotors, flow(), 2.2, 16.0)
        x = Controls(jnp.zeros(()), jnp.zeros(()), jnp.zeros(0), jnp.stack([pitch, pitch]), jnp.zeros(0))
        root = find_root(x, at, TANDEM)
        return respond(root.flat, x, at, TANDEM, root.phi).loads

    return lambda sense=1.0, pitch=PITCH, wing=True: jax.tree.map(lambda v: v[0], solve(pitch, sense, wing))


@pytest.fixture(scope="module")
def in_stream():
    """The rear rotor alone in a uniform stream with a swirl over the radius."""

    @jax.jit
    def solve(speed, swirl, sense):
        alone = rotor(incidence=0.0)
        plan = PLAN._replace(radial=8)
        points = disk_points(alone, plan)[0] - alone.hub[0]
        about = jnp.stack([0.0 * points[..., 0], -points[..., 2], points[..., 1]], axis=-1)
        turning = swirl[:, None, None] * about / jnp.linalg.norm(about, axis=-1, keepdims=True)
        velocity = (jnp.array([1.0, 0.0, 0.0]) * speed + turning)[None, None]
        loads = rotor_loads(
            alone._replace(sense=alone.sense * sense), plan, velocity, pitch=jnp.array([PITCH]), flow=flow()
        )
        return loads.thrust[0, 0], loads.torque[0, 0]

    return solve


def test_a_rotor_behind_another_works_in_its_slipstream(tandem, in_stream):
    """Far enough behind, the front rotor's jet has reached twice its velocity at the disk: the rear rotor, with the
    same pitch, pulls as one in a stream that is faster by so much.
    """
    load = tandem()
    front, rear = (float(v) for v in load.thrust)
    assert rear < 0.9 * front
    weights = np.asarray(blades(rotor(), PLAN._replace(radial=8)).r)[0]
    mean = float(np.average(load.v_axial[0], weights=weights))
    alone = float(in_stream(90.0, jnp.zeros(8), 1.0)[0])
    faster = float(in_stream(90.0 + 2.0 * mean, jnp.zeros(8), 1.0)[0])
    assert front == pytest.approx(alone, rel=0.03)
    opposed = tandem(-1.0)
    between = 0.5 * (rear + float(opposed.thrust[1]))  # swirl changes it by as much either way
    assert between - front == pytest.approx(faster - alone, rel=0.15)


def test_a_rotor_behind_another_without_any_wing(tandem):
    """A wing at no incidence adds little: without it the rear rotor loses as much in the front rotor's jet."""
    with_wing, without = tandem().thrust, tandem(wing=False).thrust
    np.testing.assert_allclose(without, with_wing, rtol=0.02)
    assert without[1] < 0.9 * without[0]


def test_derivatives_of_rotors_without_any_wing(tandem):
    """By the pitch of both, through the equilibrium of the two, against central differences."""
    x = Controls(jnp.zeros(()), jnp.zeros(()), jnp.zeros(0), jnp.full(2, PITCH), jnp.zeros(0))
    at = Setting(make_system([], coaxial(), TANDEM, flow().mach, MODEL), coaxial(), flow(), 2.2, 16.0)
    found, _ = jax.jit(lambda x: settle(find_root(x, at, TANDEM), x, at, TANDEM))(x)
    slope = np.sum(found.by.loads.thrust[0, :, 2:], axis=-1)
    step = 1e-4
    ends = [tandem(pitch=PITCH + sign * step, wing=False).thrust for sign in (1.0, -1.0)]
    np.testing.assert_allclose(slope, (ends[0] - ends[1]) / (2 * step), rtol=1e-6)


def test_a_counter_rotating_rotor_takes_up_the_swirl(tandem, in_stream):
    """Against the swirl the blades meet the air faster and at a larger angle, along with it slower: torque and thrust
    of the rear rotor differ by what twice the front rotor's swirl at the disk makes.
    """
    same, opposed = tandem(), tandem(-1.0)
    np.testing.assert_allclose(same.thrust[0], opposed.thrust[0], rtol=1e-2)
    assert float(opposed.torque[1]) > 1.03 * float(same.torque[1])
    assert float(opposed.thrust[1]) > 1.03 * float(same.thrust[1])
    radii = np.asarray(blades(rotor(), PLAN._replace(radial=8)).r)[0]
    swirl = -2.0 * same.v_swirl[0]  # inboard-up turns negatively
    mean = float(np.average(same.v_axial[0], weights=radii))
    ends = [in_stream(90.0 + 2.0 * mean, swirl, turn) for turn in (1.0, -1.0)]
    for i, found in enumerate((opposed.thrust[1] - same.thrust[1], opposed.torque[1] - same.torque[1])):
        assert float(found) == pytest.approx(float(ends[1][i] - ends[0][i]), rel=0.2)


def test_upwash_of_others_turns_a_slipstream_as_incidence_does(w=0.02):
    """Far behind, inside and outside, at any thrust: with what edges make of an upwash that is there too (a
    dielectric) it is the turn of a slipstream at incidence, a law of another source.
    """
    rotors, at = rotor(incidence=0.0), flow()
    stream = jnp.broadcast_to(jnp.array([at.speed, 0.0, 0.0]), (1, 1, 4, 4, 3))
    loads = rotor_loads(rotors, SINGLE, stream, pitch=jnp.asarray([PITCH + 0.15]), flow=at)
    upwash = jnp.broadcast_to(jnp.array([0.0, 0.0, w]), (1, 1, 4, 4, 3))
    turned = wake_behind(loads, rotors, SINGLE, at, upwash)
    straight = wake_behind(loads, rotors, SINGLE, at, 0.0 * upwash)
    np.testing.assert_array_equal(turned.axial, straight.axial)
    v = float(disk_mean(blades(rotors, SINGLE).r[0], straight.axial[0, 0], rotors.radius[0]))
    assert 0.08 < v < 0.2

    def across(wake, wind, slope):
        centre = rotors.hub[0] + 60.0 * jnp.array([1.0, 0.0, slope])
        points = centre + jnp.array([[0.0, 0.0, 0.0], [0.0, 3.0, 0.0]])
        return np.asarray(slipstreams(rotors, SINGLE, wake, points, winds=jnp.array([wind]))[0, 0, :, 2])

    by_others = across(turned, [1.0, 0.0, 0.0], 0.0)
    by_incidence = across(straight, [1.0, 0.0, w], w / (1.0 + v))
    assert np.all(np.abs(by_incidence) > 0.1 * v * w)
    jet = 1.0 + 2.0 * v
    contracted = rotors.radius[0] ** 2 * (1.0 + v) / jet
    edges = w * np.array([2.0 * jet / (jet**2 + 1.0) - 1.0, float(reflection(jet**2) * contracted / 3.0**2)])
    np.testing.assert_allclose(by_others + edges, by_incidence, rtol=0.015)


def test_a_blade_that_begins_on_the_axis(at, root):
    """Its innermost edge has no radius; by the strength of the slipstream and by the place of its axis."""
    whole = rotor()._replace(hub_radius=jnp.zeros(1), r=rotor().r.at[0, 0].set(0.0))

    def lifts(v):
        there = at._replace(rotors=whole._replace(hub=whole.hub.at[0, 1:].add(v[1:])))
        return respond((1.0 + v[0]) * root.flat, state(), there, PLAN).gamma[0]

    slopes = jax.jit(jax.jacfwd(lifts))(jnp.zeros(3))
    assert np.all(np.isfinite(slopes)) and np.all(np.max(np.abs(slopes), axis=0) > 1e-3)
