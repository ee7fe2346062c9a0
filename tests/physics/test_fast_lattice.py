"""The lattice in blocks against the reference lattice, and its gradients against differences."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from hera_om.physics import fast_lattice
from hera_om.physics.fast_derivatives import Reference, response
from hera_om.physics.geometry import Panels
from hera_om.physics.lattice import assemble, ring_velocities, shapes, solve
from hera_om.physics.lattice_forces import filament_forces, filament_strengths, resultant, strip_loads
from hera_om.physics.layout import FREE, PLANE, ROOTED, SINGLE, layout

MACH = 0.5
KINDS = (ROOTED, FREE, PLANE)


def plate(x, y, z, *, nc=3, ns=4, chord=1.0, twist=0.05):
    """A swept, twisted plate from (y0, z0) to (y1, z1) with one mirrored and one reversed control."""
    eta, xi = np.linspace(0, 1, ns + 1) ** 0.8, np.linspace(0, 1, nc + 1)[:, None]
    ahead = chord * (xi - 0.25) * (1 - 0.3 * eta)
    mesh = jnp.stack(
        [x + 0.4 * eta + ahead, y[0] + (y[1] - y[0]) * eta + 0 * xi, z[0] + (z[1] - z[0]) * eta + 0 * xi], -1
    )
    if y[1] > y[0]:
        mesh = mesh.at[..., 2].add(-twist * ahead * (1 + eta))
    return panels_of(mesh)


def panels_of(mesh):
    along = mesh[1:] - mesh[:-1]
    rear = mesh[:-1] + 0.75 * along
    across, middle = rear[:, 1:] - rear[:, :-1], (rear[:, 1:] + rear[:, :-1]) / 2
    normal = jnp.cross((along[:, 1:] + along[:, :-1]) / 2, across)
    normal = normal / jnp.linalg.norm(normal, axis=-1, keepdims=True)
    turn = jnp.cross(across, normal).at[:-1].set(0.0)
    return Panels(
        rings=jnp.concatenate([mesh[:-1] + 0.25 * along, mesh[-1:]]),
        collocation=middle,
        across=jnp.stack([middle, across]),
        normal=normal,
        normal_hinge=jnp.stack([jnp.stack([turn, turn]), jnp.stack([turn, -turn])]),
        strip_edges=mesh[0],
        middle=jnp.full(mesh.shape[1] - 1, 0.5),
        strip_chord=jnp.ones(mesh.shape[1] - 1),
        strip_width=jnp.ones(mesh.shape[1] - 1),
    )


SURFACES = [plate(0.0, (0.0, 4.0), (0.0, 0.3)), plate(5.0, (0.5, 2.0), (1.0, 1.0)), plate(4.5, (0.0, 0.0), (0.2, 1.5))]
REFERENCE = Reference(8.0, 1.0, 8.0, jnp.asarray([0.3, 0.0, 0.1]))
RANDOM = np.random.default_rng(0)


def close(ours, reference, rtol=1e-12):
    np.testing.assert_allclose(ours, reference, rtol=0, atol=rtol * np.max(np.abs(reference)))


@pytest.fixture(scope="module", params=[128, 7], ids=["one block", "many blocks"])
def block(request):
    """Few points in one block, or in many with the last one filled up."""
    patch = pytest.MonkeyPatch()
    patch.setattr(fast_lattice, "BLOCK", request.param)
    yield
    patch.undo()


def test_influence_is_that_of_whole_arrays(block):
    """`lattice` takes one or the other, by what it needs."""
    points = jnp.asarray(RANDOM.uniform(-3, 6, (17, 3)))
    axes, rings = jnp.broadcast_to(jnp.eye(3), (17, 3, 3)), [s.rings for s in SURFACES]
    mixtures = fast_lattice.EVEN, fast_lattice.ODD
    found = fast_lattice.influence(points, axes, rings, beta=0.8, mixtures=mixtures)
    own, image = ring_velocities(points, SURFACES, jnp.asarray(0.8))
    for ours, reference in zip(found, (own + image, own - image), strict=True):
        close(ours[:17], reference)


def test_circulations_and_velocities_are_those_of_the_lattice(block):
    reference, _ = assemble(SURFACES, jnp.asarray(MACH), kinds=KINDS, lateral=True)
    ours = fast_lattice.assemble(SURFACES, MACH, kinds=KINDS, lateral=True)
    rhs = jnp.asarray(RANDOM.normal(size=(len(ours.normal), 2)))
    even, odd = fast_lattice.solve(ours, rhs), fast_lattice.solve(ours, rhs, odd=True)
    close(even, solve(reference.even, rhs))
    close(odd, solve(reference.odd, rhs))
    velocity = fast_lattice.velocities(ours, reference.points, even, odd)
    close(velocity[:2], jnp.einsum("ein,nm->mei", reference.even.velocity, even))
    close(velocity[2:], jnp.einsum("ein,nm->mei", reference.odd.velocity, odd))


def test_derivatives_of_the_products():
    nodes = SURFACES[0].rings
    rows = [jnp.asarray(RANDOM.normal(size=(2, n))) for n in (12, 15)]
    points = jnp.asarray(RANDOM.uniform(-2, 4, (5, 3)))

    def products(q, n, *x):
        return fast_lattice.ring_products(q, n, *x)

    change = [jnp.asarray(RANDOM.normal(size=a.shape)) for a in (points, nodes, *rows)]

    def along(t):
        return products(*(a + t * d for a, d in zip((points, nodes, *rows), change, strict=True)))

    step = 1e-4
    first = jax.jacfwd(along)(0.0)
    close(first, (8 * (along(step) - along(-step)) - along(2 * step) + along(-2 * step)) / (12 * step), 1e-8)
    second = jax.jacfwd(jax.jacfwd(along))(0.0)
    close(second, (jax.jacfwd(along)(step) - jax.jacfwd(along)(-step)) / (2 * step), 1e-6)
    weight = jnp.asarray(RANDOM.normal(size=first.shape))
    back = jax.grad(lambda a: jnp.sum(weight * products(*a)))((points, nodes, *rows))
    total = sum(jnp.sum(b * d) for b, d in zip(back, change, strict=True))
    assert float(total) == pytest.approx(float(jnp.sum(weight * first)), rel=1e-11)


def coefficients(state, surfaces=SURFACES, **how):
    return response(surfaces, state, REFERENCE, mach=MACH, kinds=KINDS, reversed_entries=(1, 2, 4, 6), **how)


@pytest.mark.parametrize("lateral", [False, True])
def test_derivatives_by_the_state_against_differences(lateral):
    state = jnp.asarray([0.06, 0.0, 0.0, 0.01, 0.0, 0.02, 0.0])
    if lateral:
        state = jnp.asarray([0.06, 0.04, 0.02, 0.01, -0.03, 0.02, 0.05])
    value = jax.jit(lambda x: coefficients(x, lateral=True).values)
    by = jax.jit(lambda x: coefficients(x, by=tuple(range(7)), lateral=lateral))(state)
    differences = jnp.stack([(value(state + d) - value(state - d)) / 2e-4 for d in 1e-4 * jnp.eye(7)], axis=1)
    close(by.values, value(state), 1e-10)
    close(by.by, differences, 1e-7)


@pytest.mark.parametrize("chordwise", [True, False], ids=["all filaments", "bound filaments"])
def test_forces_are_those_of_the_lattice(chordwise):
    lattice, _ = assemble(SURFACES, jnp.asarray(MACH), kinds=KINDS)
    plan = layout(shapes(SURFACES), KINDS, chordwise_loads=chordwise)
    wind = jnp.asarray([np.cos(0.06), 0.0, np.sin(0.06)])
    gamma = solve(lattice.even, -lattice.normal @ wind)
    forces = filament_forces(lattice, filament_strengths(plan, gamma), wind + lattice.even.velocity @ gamma)
    force, moment = resultant([strip_loads(lattice, plan, forces)], plan, REFERENCE.point)
    ours = coefficients(jnp.zeros(7).at[0].set(0.06), chordwise_loads=chordwise).values
    lift, drag = force[2] * wind[0] - force[0] * wind[2], force @ wind
    close(ours[jnp.asarray([0, 1, 4])], jnp.stack([lift, drag, moment[1] / REFERENCE.c]) / REFERENCE.S)


def test_gradients_by_the_nodes_against_differences():
    state = jnp.asarray([0.06, 0.0, 0.0, 0.01, 0.0, 0.02, 0.0])
    mesh = jnp.asarray(SURFACES[0].rings)
    change = jnp.asarray(RANDOM.normal(size=mesh.shape)) * 0.1
    change = change.at[:, 0, 1].set(0.0)

    @jax.jit
    def values(nodes):
        out = coefficients(state, [panels_of(nodes), *SURFACES[1:]], by=(0, 3))
        return jnp.concatenate([out.values[jnp.asarray([0, 1, 4])], out.by[jnp.asarray([0, 4])].ravel()])

    step = 1e-4
    differences = (values(mesh + step * change) - values(mesh - step * change)) / (2 * step)
    gradient = jax.jit(jax.jacrev(values))(mesh)
    close(jnp.tensordot(gradient, change, axes=3), differences, 1e-6)
    assert np.all(np.abs(np.asarray(differences)) > 1e-4)


def test_a_surface_without_image_is_refused():
    with pytest.raises(ValueError, match="without an image"):
        fast_lattice.assemble(SURFACES[:1], MACH, kinds=(SINGLE,))
