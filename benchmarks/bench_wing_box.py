"""The wing box against OpenAeroStruct's, at the same number of stations, in one run.

    python benchmarks/bench_wing_box.py [--peers PYTHON]

PYTHON is an interpreter with openaerostruct. After compilation or set-up, CPU milliseconds of one thread. Ours sizes
all sheets for six load cases with buckling, and differentiates mass and both reserve factors by loads, planform and
areas. Theirs analyses given sheets in one condition, coupled with a lattice of one panel along the chord, and
differentiates fuel, failure and lift by its 25 variables: less sizing, more coupling, so the ratio is a rough one.
"""

import argparse
import json
import os
import subprocess
import sys
from pathlib import Path

os.environ.setdefault("OMP_NUM_THREADS", "1")
HERE = Path(__file__).parent
STATIONS, CASES = 24, (2.5, 1.0, -1.0, 2.8, -0.6, 1.7)


def ours():
    """Value, and the gradient of mass and both reserve factors by all loads, the planform and the areas."""
    from hera_om.core.precision import enable

    enable()
    import jax
    import jax.numpy as jnp
    import numpy as np

    from hera_om.core.contours import contour_table
    from hera_om.physics.wingbox import size_box
    from hera_om.physics.wingbox_types import BoxConcept, BoxGeometry, BoxLoads, Material

    y = jnp.linspace(1.45, 14.5, STATIONS)
    chord, ratio = (
        jnp.interp(y, jnp.asarray([5.6, 14.5]), jnp.asarray([2.77, 1.61])),
        jnp.linspace(0.18, 0.13, STATIONS),
    )
    tables = jnp.broadcast_to(jnp.asarray(contour_table("NACA 43018")), (STATIONS, 4, 65))
    shape = jnp.asarray(CASES)[:, None] * (1.0 - np.asarray(y) / 14.5)
    loads = BoxLoads(8e4 * shape, 4.7e5 * shape * (1 - y / 14.5), 1e4 * shape, 3e3 * shape, 2e4 * shape)
    material = Material(71.7e9, 26.9e9, 0.33, 2810.0, 476e6, 469e6, 538e6, 324e6)
    concept = BoxConcept(0.15, 0.62, 0.6, 0.15, 0.0012)

    def run(loads, chord, ratio, cap, stringer):
        edge = jnp.stack([11.0 + 0.0 * chord, y, 0.0 * chord], axis=1)
        geometry = BoxGeometry(edge, chord, ratio, tables=tables)
        box = size_box(geometry, material, concept, loads=loads, A_cap_root=cap, A_stringer_root=stringer)
        return jnp.stack([box.m_primary, box.RFC, box.RFT])

    args = loads, chord, ratio, jnp.asarray(3e-3), jnp.asarray(3.5e-4)
    value, totals = jax.jit(run), jax.jit(jax.jacrev(run, argnums=(0, 1, 2, 3, 4)))
    return {"run": lambda: value(*args).block_until_ready(), "totals": lambda: jax.block_until_ready(totals(*args))}


def main():
    """Time ours, and theirs where there is an interpreter for it."""
    sys.path.insert(0, str(HERE))
    from measure import cpu_time

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--peers", help="Python that has openaerostruct")
    options = parser.parse_args()
    for what, call in ours().items():
        print(f"hera_om, {STATIONS} stations, {len(CASES)} cases, {what}: {1e3 * cpu_time(call):.2f} ms")
    if options.peers:
        command = [options.peers, "-W", "ignore", str(HERE / "peers" / "openaerostruct_box.py"), str(STATIONS)]
        environment = {**os.environ, "OPENMDAO_REPORTS": "0"}
        done = subprocess.run(command, capture_output=True, text=True, env=environment, timeout=600, check=True)
        for line in done.stdout.splitlines():
            if line.startswith('{"program"'):
                row = json.loads(line)
                print(f"{row['program']}, {STATIONS} stations, {row['what']}: {1e3 * row['seconds']:.2f} ms")


if __name__ == "__main__":
    main()
