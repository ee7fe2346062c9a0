"""The tests check the shapes annotated in hera_om.physics, inside jit and out (--jaxtyping-packages)."""

import jax
import jax.numpy as jnp
import pytest
from jaxtyping import TypeCheckError

from hera_om.physics.atmosphere import isa


@pytest.mark.parametrize("transform", [lambda f: f, jax.jit, lambda f: jax.jit(jax.jacfwd(f))])
def test_a_wrong_shape_is_refused_and_the_right_one_passes(transform):
    function = transform(isa)
    with pytest.raises(TypeCheckError):
        function(jnp.zeros(3))
    result = function(jnp.asarray(1000.0))
    assert all(leaf.dtype == jnp.float64 for leaf in jax.tree.leaves(result))
