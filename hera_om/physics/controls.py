"""Trailing-edge controls: how a command turns the normals of the panels behind a hinge line."""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from hera_om.physics.geometry import Grid, Numbers, Panels, Sections, make_panels


class Control(NamedTuple):
    """One control of a surface; the pairs are at its inner and outer end, linear between.

    A positive deflection, gain times the command, turns by the right-hand rule about the hinge line as it runs from
    root to tip.
    """

    command: Float[Numbers, " k"]  # 1 at the command it answers to, else 0
    ends: Float[Numbers, " 2"]  # in the coordinate along the span
    hinge: Float[Numbers, " 2"]  # chord fractions
    gain: Float[Numbers, " 2"]
    mirror: Float[Numbers, ""] | float  # deflection of the port half over that of the starboard half
    axis: Float[Numbers, " 3"] | None = None  # of the rotation instead of the hinge line


def controlled_panels(
    sections: Sections,
    grid: Grid,
    shape: str,
    *,
    station: Float[Array, " k"],
    controls: tuple[Control, ...],
    commands: int,
) -> Panels:
    """Panels of a surface with the derivatives of their normals by every command.

    The normals of the panels behind the hinge turn about the hinge line, by the share of a panel that it cuts, as
    in AVL: dn = share gain (h x n).

    Args:
        sections: sections of the surface.
        grid: its cut.
        shape: see `geometry.surface_mesh`.
        station: coordinate of the sections along the span, m.
        controls: its controls.
        commands: number of commands of the aircraft.

    Returns:
        Panels with ``normal_hinge`` filled in.
    """
    panels = make_panels(sections, grid, shape)
    total = jnp.zeros((2, commands, *panels.normal.shape))
    for control in controls:
        share = hinge_share(grid, station, control)[..., None]
        axes = jnp.broadcast_to(_axes(sections, grid, station, control), panels.normal.shape)
        turn = share * jnp.cross(axes, panels.normal)
        halves = jnp.stack([jnp.ones(()), jnp.asarray(control.mirror, float)])
        total = total + jnp.einsum("h,k,cij->hkcij", halves, jnp.asarray(control.command), turn)
    return panels._replace(normal_hinge=total)


def hinge_share(grid: Grid, station: Float[Array, " k"], control: Control) -> Float[Array, "nc ns"]:
    """Share of every panel that lies behind the hinge line and between the ends, times the gain."""
    edges = grid.weights @ station
    part = _part((edges[1:] + edges[:-1]) / 2, control)
    hinge, gain = (_between(pair, part) for pair in (control.hinge, control.gain))
    width = jnp.diff(grid.xi)[:, None]
    along = jnp.clip((grid.xi[1:, None] - jnp.maximum(grid.xi[:-1, None], hinge)) / width, 0.0, 1.0)
    inner, outer = jnp.maximum(edges[:-1], control.ends[0]), jnp.minimum(edges[1:], control.ends[1])
    return gain * along * jnp.clip((outer - inner) / jnp.diff(edges), 0.0, 1.0)


def _part(at, control: Control):
    """Where a place along the span lies in a control, 0 at its inner to 1 at its outer end."""
    return jnp.clip((at - control.ends[0]) / (control.ends[1] - control.ends[0]), 0.0, 1.0)


def _between(pair, part):
    """Linear between two ends."""
    return pair[0] + (pair[1] - pair[0]) * part


def _axes(sections: Sections, grid: Grid, station, control: Control) -> Float[Array, "..."]:
    """Unit vectors of the rotation: along the hinge line of every strip, or the given axis."""
    if control.axis is not None:
        axis = jnp.asarray(control.axis, float)
        return axis / jnp.linalg.norm(axis)
    x_le, y, z, chord, _ = (grid.weights @ s for s in sections)
    hinge = _between(control.hinge, _part(grid.weights @ station, control))
    line = jnp.diff(jnp.stack([x_le + hinge * chord, y, z], axis=-1), axis=0)
    return line / jnp.linalg.norm(line, axis=-1, keepdims=True)
