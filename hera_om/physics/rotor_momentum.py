"""Momentum theory of an annulus from the propeller to the windmill state, and Prandtl's losses."""

import jax.numpy as jnp
from jaxtyping import Array, Float

Field = Float[Array, "nr npsi"]
Column = Float[Array, "nr 1"]

BUHL_ONSET = 1.5**0.5
"""Relative inflow where Buhl's line leaves momentum theory, at a = 0.4 (NREL/TP-500-36834, 2005)."""
BUHL_SHAPE = (-0.392, 1.789)
"""Shape of the bridge over the turbulent-wake state, fitted to Buhl's C_T to 0.04 over 0.4 < a < 1."""
TURBULENT_WAKE = 1.0
"""Share of that bridge in the mass flow; zero would leave plain momentum theory."""
LEAST_MASS_FLOW = 1e-4
"""Floor of the mass-flow ratio where neither inflow nor thrust moves air (regularisation)."""
LEAST_LOSS = 1e-4
"""Floor of the loss factor at the very tip and hub."""


def _turbulent_wake(xi: Field) -> Field:
    """Bridge over -1 < xi < BUHL_ONSET, 1 at the middle, with two vanishing derivatives at both ends."""
    x = jnp.clip(xi, -1.0, BUHL_ONSET)
    shape = 1.0 + x * (BUHL_SHAPE[0] + x * BUHL_SHAPE[1])
    return TURBULENT_WAKE * ((1.0 - x / BUHL_ONSET) * (1.0 + x)) ** 3 * shape


def mass_flow(sine: Field, thrust: Field, loss: Field) -> Field:
    """Mass-flow ratio m = V' / W: |sin(phi)|, raised where the thrust opposes the stream (see
    ``solve_rotor``).

    ``thrust`` is sigma cn / 4F. The relative inflow xi = -sin(phi) sign(thrust) / sqrt|thrust| is at least
    1.22 in the windmill state and at most -1 in the propeller state.
    """
    magnitude = jnp.abs(thrust)
    bridged = magnitude > sine**2 / BUHL_ONSET**2
    safe = jnp.where(bridged, magnitude, 1.0)
    xi = -sine * jnp.sign(thrust) / jnp.sqrt(safe)
    bridge = jnp.where(bridged, safe * _turbulent_wake(xi) / (2.0 * loss), 0.0)
    return jnp.sqrt(sine**2 + bridge + LEAST_MASS_FLOW**2)


def prandtl_loss(factor: Column, sine: Field) -> Field:
    """Prandtl's factor 2/pi arccos(exp(-f)), f = factor / |sin(phi)|, after Glauert."""
    f = factor / jnp.sqrt(sine**2 + LEAST_MASS_FLOW**2)
    return jnp.maximum(2.0 / jnp.pi * jnp.arccos(jnp.exp(-jnp.maximum(f, LEAST_LOSS**2))), LEAST_LOSS)
