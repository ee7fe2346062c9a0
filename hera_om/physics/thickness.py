"""Flow of the thickness of lifting surfaces, which slows the air ahead of them and so loads rotors there.

A thin symmetric section is a sheet of sources on its chord, as strong as its thickness grows in the stream (Katz &
Plotkin, Low-Speed Aerodynamics 2e, section 5.2). By strip and station of the chord (`airfoil.STATIONS`) it becomes
lines of sources from edge to edge of the strip: a tenth of the chord ahead of the nose the velocity is within 1.5 %.

A surface that pushes air ahead feels the air that rotors push behind: in a slipstream the pressure falls from the disk
on, and the thickness meets that as drag, `buoyancy`. What rotors gain of thrust at given power the surface pays.

Valid for thin sections, to first order in thickness and in the slipstream, off the surface.
"""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from hera_om.physics.airfoil import STATIONS
from hera_om.physics.geometry import Grid, Sections
from hera_om.physics.vortex_kernel import FOUR_PI, segment

THICKNESS = 1.0
"""Share of the flow of thickness and of its drag in slipstreams; 0 switches them off."""


class SourceLines(NamedTuple):
    """Lines of sources of the starboard half."""

    start: Float[Array, "q 3"]  # m
    end: Float[Array, "q 3"]
    flux: Float[Array, " q"]  # of a line over the flight speed: growth of thickness times width, m^2


def strip_growth(grid: Grid, chord: Float[Array, " k"], ratio: Float[Array, " k"]) -> Float[Array, "t s"]:
    """Growth of the thickness of every strip at the stations, m.

    Args:
        grid: of the surface.
        chord: of its sections, m.
        ratio: their thickness ratios.
    """
    edges = jnp.asarray(grid.weights) @ ((chord * ratio)[:, None] * jnp.asarray(grid.growth))
    return (edges[:-1] + edges[1:]).T / 2.0


def source_lines(sections: Sections, grid: Grid, growth: Float[Array, "t s"], width: Float[Array, " s"]) -> SourceLines:
    """The lines of one surface on its chord, whose twist they leave out.

    Args:
        sections: of the surface.
        grid: its strips.
        growth: see `strip_growth`.
        width: of the strips, m.
    """
    x_le, y, z, chord = (jnp.asarray(grid.weights) @ v for v in (sections.x_le, sections.y, sections.z, sections.chord))
    x = x_le + STATIONS[:, None] * chord
    points = jnp.stack([x, jnp.broadcast_to(y, x.shape), jnp.broadcast_to(z, x.shape)], axis=-1)
    return SourceLines(points[:, :-1].reshape(-1, 3), points[:, 1:].reshape(-1, 3), (growth * width).ravel())


def source_velocity(points: Float[Array, "p 3"], lines: SourceLines, beta) -> Float[Array, "p 3"]:
    """Velocity over the flight speed that the lines induce; without their image.

    A line of unit flux by length has, with r1 and r2 from its ends, h from its foot and its direction e,
    ``4 pi V = e (1/r2 - 1/r1) + h (e.r1/r1 - e.r2/r2) / h^2``; the second factor is that of a vortex,
    `vortex_kernel.segment`, times the length. Compressibility after Goethert: x is stretched by 1/beta, as are flux
    and velocity along x.

    Args:
        points: m.
        lines: sources.
        beta: sqrt(1 - M^2).
    """
    stretch = jnp.stack([1.0 / beta, jnp.ones_like(beta), jnp.ones_like(beta)])
    p, a, b = points * stretch, lines.start * stretch, lines.end * stretch
    length2 = jnp.sum((b - a) ** 2, axis=-1)
    length = jnp.sqrt(length2)
    one, two = p[:, None] - a, p[:, None] - b
    s1, s2 = jnp.sum(one**2, axis=-1), jnp.sum(two**2, axis=-1)
    r1, r2 = jnp.sqrt(s1), jnp.sqrt(s2)
    flux, along = lines.flux / beta, (b - a) / length[:, None]
    across = flux * segment(r1, r2, s1, s2, length2)  # flux by length times length
    line = flux / length * (1.0 / r2 - 1.0 / r1) / FOUR_PI - across * jnp.sum(one * along, axis=-1)
    return stretch * (jnp.einsum("pq,pqi->pi", across, one) + line @ along)


def on_panels(grid: Grid, growth: Float[Array, "t s"]) -> Float[Array, " n"]:
    """Growth of thickness by panel, m: that of the stations shared by the bound filaments beside them.

    What is linear between two filaments, and beyond the first and the last, is summed as the stations would; a single
    panel has no drag of its thickness.
    """
    xi = jnp.asarray(grid.xi)
    at = xi[:-1] + grid.front * jnp.diff(xi)
    if at.shape[0] == 1:
        return jnp.zeros(growth.shape[1])
    i = jnp.clip(jnp.searchsorted(at, STATIONS) - 1, 0, at.shape[0] - 2)
    share = (STATIONS - at[i]) / (at[i + 1] - at[i])
    stations = jnp.arange(STATIONS.size)
    shares = jnp.zeros((at.shape[0], STATIONS.size)).at[i, stations].add(1.0 - share).at[i + 1, stations].add(share)
    return (shares @ growth).ravel()


def buoyancy(
    growth: Float[Array, " b"], width: Float[Array, " b"], along: Float[Array, " b"], *, mach
) -> Float[Array, " b"]:
    """Force along the stream on the thickness in slipstreams, over dynamic pressure, m^2.

    Sources Q in a velocity u feel -rho Q u; ahead of the disk and behind it the pressure changes by -rho V du, and
    what changes at the disk alone has no part in it, as a closed section takes in what it gives out. The pressure of a
    force grows with 1 / (1 - M^2), as the sources' flow at the force does; that it is stretched along x as well is left
    out, which is up to 12 % too much drag at Mach 0.5.

    Args:
        growth: of thickness, m, of each piece.
        width: of the pieces along the span, m.
        along: velocity of the slipstreams along the stream over the flight speed, as without compressibility.
        mach: Mach number.
    """
    return -2.0 * growth * width * along / (1.0 - mach**2)
