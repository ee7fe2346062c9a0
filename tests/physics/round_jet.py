"""A wing of chord 1 through concentric round jets, of infinite span or with its middle in them, by boundary elements.

With Phi = V phi (local speed of the stream times potential) the linear problem is that of a dielectric: at an edge
Phi and dPhi/dn / V^2 are continuous, the jump of Phi over wing and wake is V Gamma, the lift, continuous too; on the
wing dPhi/dz = -V^2 times the incidence. The edges are cylinders of sources sigma = 2 k (dPhi/dn of all else), k as in
`finite_jet.reflection`; the wing a lattice of quarter and three-quarter points. Unknown is the change of the lift
against the wing in the plain stream, so that an infinite one has no tips; lifts are over a plate's.

Sources run along x between the panels' ends and are integrated exactly, the first and the last to infinity. Symmetry
by y = 0, or the reverse for an odd load such as a swirl's; reversed by z = 0.
"""

import numpy as np
from scipy.optimize import brentq

REACH, STRIPS = 40.0, 20  # half span, chords, and strips from the last edge to there
AROUND, ALONG, SUB = 16, 48, 3  # panels of a quarter of a cylinder


def horseshoes(points, x, inner, outer):
    """Velocity [p, s, 3] of horseshoes of unit strength, bound at x between y inner and outer, legs aft."""
    px, py, pz = (points[:, i, None] for i in range(3))

    def leg(y):
        d2 = (py - y) ** 2 + pz**2
        f = (1 + (px - x) / np.sqrt((px - x) ** 2 + d2)) / (4 * np.pi * d2)
        return np.stack([0 * f, -pz * f, (py - y) * f], -1)

    h2 = (px - x) ** 2 + pz**2
    ends = [(py - y) / np.sqrt(h2 + (py - y) ** 2) for y in (inner, outer)]
    bound = (ends[0] - ends[1]) / (4 * np.pi * h2)
    return np.stack([pz * bound, 0 * bound, -(px - x) * bound], -1) - leg(inner) + leg(outer)


def strips(radii, inside, half_span):
    """Edges and middles of strips from the axis out; edges of jets are edges of strips, dense on both sides."""
    edges, middles = [0.0], []
    for low, high in zip([0.0, *radii[:-1]], radii, strict=True):
        n = max(3, round(inside * (high - low) / radii[-1]))

        def place(u, low=low, high=high):
            return low + (high - low) * (np.sin(u * np.pi / 2) if low == 0 else (1 - np.cos(u * np.pi)) / 2)

        edges += list(place(np.arange(1, n + 1) / n))
        middles += list(place((np.arange(n) + 0.5) / n))
    first = edges[-1] - edges[-2]
    q = brentq(lambda q: first * (q**STRIPS - 1) / (q - 1) - (half_span - radii[-1]), 1.01, 5.0)

    def beyond(i):
        return radii[-1] + first * (q**i - 1) / (q - 1)

    return np.array([*edges, *beyond(np.arange(1, STRIPS + 1))]), np.array([*middles, *beyond(np.arange(STRIPS) + 0.5)])


class RoundJets:
    """Influences for given radii, of loads that are symmetric along the span or reversed.

    ``normal`` is the normal velocity of the plain stream by the chord fraction, of a plate by default.
    """

    def __init__(self, radii, chordwise=4, inside=12, odd=False, half_span=None, normal=None):
        self.image = -1.0 if odd else 1.0  # of the load on the other half
        self.radii, self.chordwise = np.array(radii, float), chordwise
        edges, self.middle = strips(list(radii), inside, half_span or REACH + radii[-1])
        self.edges, self.width, self.strips = edges, np.diff(edges), len(self.middle)
        self.bound, self.met = ((np.arange(chordwise) + part) / chordwise for part in (0.25, 0.75))
        self.points = np.array([[x, y, 0.0] for x in self.met for y in self.middle])

        def influence(points):
            pairs = [(1.0, edges[:-1], edges[1:]), (self.image, -edges[1:], -edges[:-1])]
            each = [sum(sign * horseshoes(points, x, *ends) for sign, *ends in pairs) for x in self.bound]
            return np.concatenate(each, axis=1)

        self.lattice = influence(self.points)[:, :, 2]
        normal = np.ones(chordwise) if normal is None else normal(self.met)
        self.normal = np.repeat(normal, self.strips)
        plane = -1 / (2 * np.pi * (self.met[:, None] - self.bound))
        self.plate, section = (np.linalg.solve(plane, -v) for v in (np.ones(chordwise), normal))
        self._sources()
        flow = influence(self.centres)
        self.onto = np.einsum("psk,pk->ps", flow, self.normals)
        if half_span is None:
            dx, z = self.centres[:, :1] - self.bound, self.centres[:, 2:]
            self.onto_plain = -(dx / (dx**2 + z**2)) @ section / (2 * np.pi) * self.normals[:, 2]
            self.plain = np.repeat(section, self.strips)  # lift without jets
        else:
            self.plain = np.linalg.solve(self.lattice, -self.normal)
            self.onto_plain = self.onto @ self.plain

    def _sources(self):
        """Panels of a quarter of every cylinder, with their mirror images: on each other and on the wing."""
        turn = np.pi / 2 * np.linspace(0, 1, AROUND + 1) ** 1.5
        middle = (turn[1:] + turn[:-1]) / 2
        u = np.sinh(np.linspace(-6, 6, ALONG - 1))
        inner = 0.5 + u / u[-1] * 60 * (1 + self.radii[-1])
        ends = np.array([-1e7, *inner, 1e7])
        along = np.array([2 * inner[0], *(inner[1:] + inner[:-1]) / 2, 2 * inner[-1]])
        count, n, p = len(self.radii), len(along), len(self.points)
        cross, wing = np.zeros((count, n, AROUND, count, n, AROUND)), np.zeros((p, count, n, AROUND))
        images = [(1, 1, 0.0), (1, -1, 0.0), (-1, 1, np.pi), (-1, -1, np.pi)]
        for b, j, sub in np.ndindex(count, AROUND, SUB):
            step = (turn[j + 1] - turn[j]) / SUB
            for sy, sz, base in images:
                angle = base + sy * sz * (turn[j] + (sub + 0.5) * step)
                sign, rb = sz * step * (1.0 if sy > 0 else self.image), self.radii[b]
                for a, ra in enumerate(self.radii):
                    d2 = ra**2 + rb**2 - 2 * ra * rb * np.cos(middle - angle) + 1e-30
                    normal = (ra - rb * np.cos(middle - angle)) / d2 if a != b else np.full(AROUND, 0.5 / ra)
                    reach = (ends - along[:, None])[:, None]
                    slope = np.diff(reach / np.sqrt(reach**2 + d2[:, None]), axis=2)
                    cross[a, :, :, b, :, j] -= sign * rb / (4 * np.pi) * normal[:, None] * slope
                dy, dz = self.points[:, 1] - rb * np.cos(angle), -rb * np.sin(angle)
                d2, reach = (dy**2 + dz**2)[:, None], ends - self.points[:, :1]
                wing[:, b, :, j] -= sign * rb / (4 * np.pi) * dz / d2 * np.diff(reach / np.sqrt(reach**2 + d2), axis=1)
        x, t = (v.ravel() for v in np.meshgrid(along, middle, indexing="ij"))
        self.centres = np.concatenate([np.stack([x, r * np.cos(t), r * np.sin(t)], -1) for r in self.radii])
        self.normals = np.tile(np.stack([0 * t, np.cos(t), np.sin(t)], -1), (count, 1))
        self.cross, self.wing = cross.reshape(count * n * AROUND, -1), wing.reshape(p, -1)

    def speed(self, y, speeds):
        """Local speed over that of the outer stream."""
        return np.append(speeds, 1.0)[np.searchsorted(self.radii, np.abs(y))]

    def answer(self, speeds):
        """Upwash of the edges on the wing by the strips' lift, and by that of the wing in the plain stream."""
        square = np.append(speeds, 1.0) ** 2
        k = np.repeat((square[:-1] - square[1:]) / (square[:-1] + square[1:]), len(self.centres) // len(self.radii))
        right = 2 * k[:, None] * np.c_[self.onto, self.onto_plain]
        out = self.wing @ np.linalg.solve(np.eye(len(k)) - 2 * k[:, None] * self.cross, right)
        return out[:, :-1], out[:, -1]

    def _strips(self, lift):
        return lift.reshape(self.chordwise, self.strips).sum(axis=0) / self.plate.sum()

    def gain(self, speeds, edges=1.0, where=1.0):
        """What the jets add to the lift, by strip; ``edges`` = 0 leaves the answer of the edges out.

        ``where`` is the share of the incidence that each strip has, for a finite span.
        """
        lift, right = self._plain(where), self._faster(speeds, where)
        by_strip, plain = self.answer(speeds)
        plain = plain if np.ndim(where) == 0 else by_strip @ lift
        return self._strips(np.linalg.solve(self.lattice + edges * by_strip, right - edges * plain))

    def _plain(self, where):
        """Lift without jets."""
        if np.ndim(where) == 0:
            return self.plain
        return np.linalg.solve(self.lattice, -self.normal * np.tile(where, self.chordwise))

    def _faster(self, speeds, where=1.0):
        """Right-hand side by the speed of the jets."""
        where = np.tile(where * np.ones(self.strips), self.chordwise)
        return (1 - self.speed(self.points[:, 1], speeds) ** 2) * self.normal * where

    def swirled(self, speeds, swirl, edges=1.0):
        """Lift by an upwash in the jets at the wing's points, over that of a plate so inclined in the plain stream."""
        right = self.speed(self.points[:, 1], speeds) * swirl
        return self._strips(np.linalg.solve(self.lattice + edges * self.answer(speeds)[0], -right))

    def modelled(self, speeds, edges, where=1.0, swirl=None):
        """The gain, or the lift by swirl, by a lattice for the lift with `finite_jet.JetEdges` of the strips."""
        one = np.eye(self.strips)
        steps = np.diff(one, axis=0, prepend=0.0, append=0.0)
        shed = np.concatenate([steps, -self.image * steps])
        arms = np.concatenate([(x - 0.25) / 0.25 * one for x in self.bound], axis=1)
        by_strip = edges.shed @ shed @ np.tile(one, self.chordwise) + edges.moment @ shed @ arms
        answer = np.tile(by_strip, (self.chordwise, 1))
        if swirl is None:
            right = self._faster(speeds, where) + answer @ self._plain(where)
        else:
            right = -self.speed(self.points[:, 1], speeds) * swirl
        return self._strips(np.linalg.solve(self.lattice - answer, right))
