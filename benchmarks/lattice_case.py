"""Our lattice on the benchmark's wing, half model, and LAPACK alone. Usage: lattice_case.py UNKNOWNS [memory]"""

import sys

import jax
import jax.numpy as jnp
import measure
import numpy as np
import scipy.linalg
import wing

from hera_om.physics.fast_derivatives import Reference, response
from hera_om.physics.geometry import QUARTER, Panels

REFERENCE = Reference(wing.AREA, wing.CHORD, wing.SPAN, jnp.asarray([wing.X_REF, 0.0, 0.0]))
BOUND = "solve, bound loads"
FLAPPED = 4  # rows of panels that the three controls turn


def panels_of(mesh):
    """Lattice geometry on corner points, with one symmetric control and two reversed ones (aileron, rudder)."""
    along = mesh[1:] - mesh[:-1]
    rear = mesh[:-1] + (1 - QUARTER) * along
    across = rear[:, 1:] - rear[:, :-1]
    middle = (rear[:, 1:] + rear[:, :-1]) / 2
    normal = jnp.cross((along[:, 1:] + along[:, :-1]) / 2, across)
    normal = normal / jnp.linalg.norm(normal, axis=-1, keepdims=True)
    unit = across / jnp.linalg.norm(across, axis=-1, keepdims=True)
    turn = jnp.cross(unit, normal) * (jnp.arange(len(along)) >= len(along) - FLAPPED)[:, None, None]
    edges = mesh[0] + QUARTER * (mesh[-1] - mesh[0])
    chord = jnp.linalg.norm(mesh[-1] - mesh[0], axis=-1)
    return Panels(
        rings=jnp.concatenate([mesh[:-1] + QUARTER * along, mesh[-1:]]),
        collocation=middle,
        across=jnp.stack([middle, across]),
        normal=normal,
        normal_hinge=jnp.stack([jnp.stack([turn, turn, turn]), jnp.stack([turn, -turn, -turn])]),
        strip_edges=edges,
        middle=jnp.full(mesh.shape[1] - 1, 0.5),
        strip_chord=(chord[1:] + chord[:-1]) / 2,
        strip_width=jnp.linalg.norm(edges[1:] - edges[:-1], axis=-1),
    )


def answer(mesh, alpha, by=(), **how):
    """Coefficients and derivatives by alpha, beta, p, q, r and three controls, or some of them."""
    state = jnp.zeros(8).at[0].set(alpha)
    return response([panels_of(mesh)], state, REFERENCE, by=by, reversed_entries=(1, 2, 4, 6, 7), **how)


def solve(mesh, alpha):
    """CL, CD, Cm."""
    return answer(mesh, alpha).values[jnp.asarray([0, 1, 4])]


def solve_bound(mesh, alpha):
    """The same with forces on the bound filaments alone."""
    return answer(mesh, alpha, chordwise_loads=False).values[jnp.asarray([0, 1, 4])]


def derivatives(mesh, alpha):
    """Every coefficient by every entry of the state, in mirrored and in reversed flow."""
    return answer(mesh, alpha, tuple(range(8))).by


def three(mesh, alpha):
    """CL_alpha, Cm_alpha, Cm_q."""
    by = answer(mesh, alpha, (0, 3)).by
    return jnp.stack([by[0, 0], by[4, 0], by[4, 1]])


def gradient_of(function):
    """Values and gradients of three numbers by all nodes and alpha."""

    def gradient(mesh, alpha):
        values, back = jax.vjp(function, mesh, alpha)
        return values, jax.vmap(back)(jnp.eye(3))

    return gradient


CASES = {
    "solve": solve,
    BOUND: solve_bound,
    "derivatives": derivatives,
    "gradient": gradient_of(solve),
    "gradient of derivatives": gradient_of(three),
}


def lapack(unknowns):
    """CPU seconds of dgetrf."""
    rng = np.random.default_rng(0)
    matrix = np.asfortranarray(rng.random((unknowns, unknowns)) + unknowns * np.eye(unknowns))
    work = matrix.copy(order="F")

    def factor():
        work[:] = matrix
        scipy.linalg.lu_factor(work, overwrite_a=True, check_finite=False)

    return measure.cpu_time(factor)


def main():
    """Times, or the extra memory of each case once it is compiled."""
    unknowns, memory = int(sys.argv[1]), "memory" in sys.argv
    arguments = jnp.asarray(wing.mesh(unknowns)), jnp.asarray(np.deg2rad(wing.ALPHA))
    names = ["solve"] if unknowns > 2000 else list(CASES)
    if not memory:
        measure.emit("LAPACK dgetrf", "solve", lapack(unknowns))
    for name in names:
        compiled = jax.jit(CASES[name]).lower(*arguments).compile()

        def run(function=compiled):
            return jax.block_until_ready(function(*arguments))

        if memory:
            measure.emit("hera_om", f"{name} memory", memory=measure.extra_memory(run))
        else:
            values = run()
            more = {"CL": float(values[0])} if name == "solve" else {}
            measure.emit("hera_om", name, measure.cpu_time(run), **more)


main()
