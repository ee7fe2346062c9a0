"""Mass properties against closed forms and the totals printed with the reference aircraft."""

import tomllib

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hera_om.physics.mass_properties import mass_properties, pair_gyration


def items(reference):
    """Arrays (mass, position, gyration) and names of the reference aircraft."""
    definition = tomllib.loads((reference / "hera_like.toml").read_text())
    rows = definition["mass"][0]["items"]
    columns = [jnp.asarray([[float(row[key]) for key in keys] for row in rows]) for keys in ("m", "xyz", ["kx", "ky"])]
    return columns[0][:, 0], columns[1], columns[2], [row["name"] for row in rows]


def test_totals_printed_with_the_reference_aircraft(reference):
    mass, position, gyration, names = items(reference)
    total = mass_properties(mass, position, gyration)
    assert float(total.mass) == 28153.0
    assert sum(m for m, name in zip(mass, names, strict=True) if name not in ("payload", "fuel")) == 18013.0
    # half a unit of the last digit that the file prints
    np.testing.assert_allclose(total.cg[0], 12.0485, rtol=0, atol=5e-5)
    np.testing.assert_allclose(total.cg[1:], [0.0, 0.343], rtol=0, atol=5e-4)
    np.testing.assert_allclose([total.I_xx, total.I_yy, total.I_zz], [4.02e5, 5.88e5, 9.46e5], rtol=0, atol=500.0)
    np.testing.assert_allclose(total.I_xz, 2.24e4, rtol=0, atol=50.0)


def test_uniform_plate():
    # thin plate a x b at its centre: Ixx = m b^2 / 12, Iyy = m a^2 / 12, Izz their sum; kx^2 = a^2 / 12
    m, a, b = 7.0, 3.0, 2.0
    total = mass_properties(jnp.asarray([m]), jnp.zeros((1, 3)), jnp.asarray([[a / np.sqrt(12.0), b / np.sqrt(12.0)]]))
    np.testing.assert_allclose(np.diag(total.inertia), m / 12.0 * np.asarray([b**2, a**2, a**2 + b**2]))


def test_mass_high_at_the_tail_has_a_positive_product_of_inertia():
    # two equal masses, one ahead and low, one aft and high, at +-(3, 0, 2): sum of m x z = 2 * 5 * 3 * 2
    total = mass_properties(jnp.asarray([5.0, 5.0]), jnp.asarray([[1.0, 0, -2.0], [7.0, 0, 2.0]]), jnp.zeros((2, 2)))
    np.testing.assert_allclose(total.I_xz, 60.0)
    np.testing.assert_allclose(total.inertia[0, 2], -60.0)


def test_pods_of_the_reference_aircraft():
    # pods at 8.00 m and 8.00 + 2.75 m: the file prints ky = 9.475
    np.testing.assert_allclose(pair_gyration(jnp.asarray([8.0, 10.75])), 9.475, atol=5e-4)


coordinate = st.floats(-20.0, 20.0)


@given(st.lists(st.tuples(st.floats(1.0, 5000.0), coordinate, coordinate, coordinate), min_size=5, max_size=5))
def test_a_shift_moves_only_the_centre_of_gravity(rows):
    table = np.asarray(rows)
    mass, position, shift = jnp.asarray(table[:, 0]), jnp.asarray(table[:, 1:]), jnp.asarray([3.0, -1.0, 2.0])
    gyration = jnp.ones((5, 2))
    here, there = (mass_properties(mass, r, gyration) for r in (position, position + shift))
    np.testing.assert_allclose(there.cg - here.cg, shift, atol=1e-12)
    np.testing.assert_allclose(there.inertia, here.inertia, atol=1e-11 * float(jnp.trace(here.inertia)))
    assert np.min(np.linalg.eigvalsh(np.asarray(here.inertia))) > 0.0


def test_parallel_axes_of_a_split_body():
    # two halves of a rod as two items are the rod: k^2 = L^2 / 12 whole, L^2 / 48 each half
    length = 6.0
    whole = mass_properties(jnp.asarray([4.0]), jnp.zeros((1, 3)), jnp.asarray([[length / np.sqrt(12.0), 0.0]]))
    halves = mass_properties(
        jnp.asarray([2.0, 2.0]),
        jnp.asarray([[length / 4, 0.0, 0.0], [-length / 4, 0.0, 0.0]]),
        jnp.full((2, 2), length / np.sqrt(48.0)) * jnp.asarray([1.0, 0.0]),
    )
    np.testing.assert_allclose(halves.inertia, whole.inertia, atol=1e-12)


def test_wrong_shapes_are_refused():
    with pytest.raises(Exception, match="gyration"):
        mass_properties(jnp.ones(3), jnp.ones((3, 3)), jnp.ones((3, 3)))


def test_derivatives(check_derivatives, reference):
    mass, position, gyration, _ = items(reference)

    def totals(x):
        moved = position.at[7, 0].set(10.0 * x[1])
        total = mass_properties(mass.at[0].set(3000.0 * x[0]), moved, gyration.at[7, 1].set(10.0 * x[2]))
        return jnp.concatenate([total.cg, total.inertia.ravel() / 1e5])

    check_derivatives(totals, [1.1, 1.075, 0.9475])
    assert jax.jit(totals)(jnp.ones(3)).shape == (12,)
