"""Oscillating lattice: Theodorsen's function, slender wings, exact kernels, limits; invariants; derivatives.

`theodorsen_rows` gives (case, quantity, reference, ours, tolerance, source) as in `test_lattice`.
"""

import csv
from itertools import pairwise

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from hera_om.physics import unsteady_lattice as module
from hera_om.physics.geometry import Sections, make_grid, make_panels
from hera_om.physics.lattice import assemble, shapes, solve
from hera_om.physics.layout import PLANE, layout
from hera_om.physics.unsteady_kernel import ramp, step
from hera_om.physics.unsteady_lattice import (
    added_strips,
    oscillate,
    pitching,
    plunge_rate,
    plunging,
    unsteady_resultant,
)

POINT = jnp.array([0.25, 0.0, 0.0])


def surface(rows, nc, ns, *, span="uniform", airfoil="flat"):
    """Panels of a surface from rows (x_le, y, z, chord, twist in rad)."""
    columns = [jnp.stack([jnp.asarray(v, float) for v in column]) for column in zip(*rows, strict=True)]
    cuts = [float(i) for i in range(len(rows))]
    grid = make_grid(cuts, [airfoil] * len(rows), nc=nc, ns=ns, span=span, chord="uniform")
    return make_panels(Sections(*columns), grid)


def rectangle(ar, nc, ns, **where):
    """A flat rectangular wing of unit chord."""
    x, y, z = (where.get(k, 0.0) for k in "xyz")
    return surface([(x, y, z, 1.0, 0.0), (x, y + ar / 2, z, 1.0, 0.0)], nc, ns)


def oscillation(panels, wavenumber, mach, pitch=False):
    """Force, moment about the quarter chord of the root and circulation in plunging, or in pitching about it."""
    lattice, _ = assemble(panels, mach)
    lay = layout(shapes(panels))

    def one(w):
        wash = pitching(lattice, w, POINT) if pitch else plunging(lattice)
        loads = oscillate(lattice, panels, lay, wash=wash, wavenumber=w, mach=mach)
        return *unsteady_resultant(lattice, loads, POINT), loads.gamma

    return jax.lax.map(one, wavenumber), lattice


_oscillation = jax.jit(oscillation, static_argnames="pitch")


def rates(panels, mach, c=1.0, mean=1.0):
    """[CX, CZ, Cm] by alphadot c / 2V over unit area about the quarter chord, and what they come from."""
    lattice, _ = assemble(panels, mach)
    lay = layout(shapes(panels))
    gamma = mean * solve(lattice.even, -lattice.normal[:, 0])
    gamma_alpha = solve(lattice.even, -lattice.normal[:, 2])
    velocity = jnp.array([1.0, 0.0, 0.0]) + lattice.even.velocity @ gamma
    given = dict(gamma=gamma, gamma_by=gamma_alpha, velocity=velocity, mach=mach, length=c)
    loads = plunge_rate(lattice, panels, lay, **given)
    force, moment = unsteady_resultant(lattice, loads, POINT)
    return jnp.stack([force[0], force[2], moment[1] / c]), loads, (lattice, gamma_alpha)


_rates = jax.jit(rates)


def theodorsen(reference):
    """k and C(k) from 0.05 to 1."""
    lines = [line for line in (reference / "theodorsen.csv").open() if not line.startswith("#")]
    rows = [(float(r["k"]), complex(float(r["F"]), -float(r["minusG"]))) for r in csv.DictReader(lines)]
    return tuple(np.array(v) for v in zip(*[r for r in rows if 0.05 <= r[0] <= 1.0], strict=True))


def plane_flow(k, **motion):
    """Lift and moment coefficients by unit angle, extrapolated in the aspect ratio from 320 and 640."""
    both = []
    for ar in (320.0, 640.0):
        (force, moment, _), _ = _oscillation([rectangle(ar, 8, 4)], jnp.asarray(2 * k), 0.0, **motion)
        both.append(np.stack([force[:, 2], moment[:, 1]]) / ar)
    return 2 * both[1] - both[0]


def theodorsen_rows(reference):
    """Modulus and phase of C(k), from the lift in plunging CL = 2 pi C + i pi k."""
    k, exact = theodorsen(reference)
    ours = (plane_flow(k)[0] - 1j * np.pi * k) / (2 * np.pi)
    out, source = [], "Theodorsen, NACA R-496"
    for kk, a, b in zip(k, exact, ours, strict=True):
        phase, found = np.degrees(np.angle(a)), np.degrees(np.angle(b))
        case = f"oscillating wing, k {kk:g}, extrapolated"
        out.append((case, "modulus of C", float(abs(a)), float(abs(b)), 0.02, source))
        out.append((case, "phase of C (deg)", float(phase), float(found), float(abs(1 / phase)), source))
    return out


def test_theodorsen_function(reference):
    for case, quantity, expected, ours, tolerance, _ in theodorsen_rows(reference):
        assert ours == pytest.approx(expected, rel=tolerance), (case, quantity)


def test_moment_in_plunging(reference):
    """Cm about the quarter chord is that of the apparent mass alone, -i pi k / 4."""
    k, _ = theodorsen(reference)
    np.testing.assert_allclose(plane_flow(k)[1], -0.25j * np.pi * k, atol=0.012 * np.pi / 4)


def test_pitching_about_the_quarter_chord(reference):
    """CL = pi (i k - k^2 / 2) + 2 pi C (1 + i k); Cm = pi / 2 (-i k + 3 k^2 / 8) (Theodorsen, NACA R-496)."""
    k, c = theodorsen(reference)
    lift, moment = plane_flow(k, pitch=True)
    exact = np.pi * (1j * k - k**2 / 2) + 2 * np.pi * c * (1 + 1j * k)
    np.testing.assert_allclose(np.abs(lift / exact), 1.0, atol=0.01)
    np.testing.assert_allclose(np.degrees(np.angle(lift / exact)), 0.0, atol=0.5)
    exact = np.pi / 2 * (-1j * k + 0.375 * k**2)
    np.testing.assert_allclose(np.abs(moment - exact) / np.abs(exact), 0.0, atol=0.02)


def wing_and_tail(chord=1.0, sweep=0.3, height=0.8, twist=0.05, scale=1.0, shift=0.0):
    """A tapered wing with dihedral, and a tail above its wake."""
    s = scale
    wing = [(shift, 0.0, 0.0, s * chord, twist), (shift + s * sweep, 3.0 * s, 0.2 * s, 0.6 * s, 0.0)]
    tail = [(shift + 4.0 * s, 0.0, s * height, 0.5 * s, 0.0), (shift + 4.1 * s, 1.2 * s, s * height, 0.4 * s, 0.0)]
    return [surface(wing, 2, 4, airfoil="NACA 2412"), surface(tail, 2, 2)]


@pytest.mark.parametrize("mach", [0.0, 0.5])
def test_the_low_frequency_is_the_limit(mach):
    """Imaginary part over k, extrapolated to k = 0 since its error is of first order (k^2 log k in the load)."""
    panels, k = wing_and_tail(twist=0.0), np.array([4e-4, 8e-4])
    (force, moment, gamma), _ = _oscillation(panels, jnp.asarray(2 * k), mach)
    _, loads, (lattice, _) = _rates(panels, mach, mean=0.0)
    straight = loads._replace(filaments=loads.filaments.at[:, 0].set(0.0))
    expected = [*(v[i] for v, i in zip(unsteady_resultant(lattice, straight, POINT), (2, 1), strict=True))]
    for ours, limit in zip((force[:, 2], moment[:, 1]), expected, strict=True):
        slope = np.asarray(ours).imag / k
        assert 2 * slope[0] - slope[1] == pytest.approx(float(limit), rel=2e-3)
    slope = np.asarray(gamma).imag / k[:, None]
    np.testing.assert_allclose(2 * slope[0] - slope[1], loads.gamma, atol=2e-3 * np.max(np.abs(loads.gamma)))


def delta(ar):
    """A delta wing of unit root chord, its tip a little clipped."""
    tip = 0.02
    return surface([(0.0, 0.0, 0.0, 1.0, 0.0), (1 - tip, ar / 4 * (1 - tip), 0.0, tip, 0.0)], 24, 12, span="sine")


@pytest.mark.parametrize("mach", [0.0, 0.6])
def test_slender_delta(mach):
    """CL_alphadot of a slender delta is that of its apparent mass: L = rho pi alphadot V times the integral of
    s^2 dx, so pi AR / 3 with the root chord, at any Mach number (slender-body theory). Extrapolated to AR 0."""
    ratio = [float(_rates([delta(ar)], mach)[0][1]) / (ar / 4) / (np.pi * ar / 3) for ar in (0.1, 0.05)]
    assert 2 * ratio[1] - ratio[0] == pytest.approx(1.0, abs=0.01)


def with_probe(at, mach):
    """Rates of a rectangular wing beside which stands a panel too small to matter, and the wash that it feels."""
    x, y, z = at
    small = surface([(x, y, z, 1e-4, 0.0), (x, y + 4e-4, z, 1e-4, 0.0)], 1, 1)
    wing = rectangle(4.0, 4, 4)
    _, loads, (lattice, gamma_alpha) = _rates([wing, small], mach, c=2.0)
    own = lattice.even.matrix[-1, -1]
    return wing, np.asarray(loads.gamma), np.asarray(gamma_alpha), float(-own * loads.gamma[-1]), lattice


@pytest.mark.parametrize("mach", [0.0, 0.6])
def test_a_distant_tail_feels_the_downwash_late(mach):
    """Between two tails far behind a wing the lag of the downwash differs by the time of flight."""
    (_, _, gamma, near, lattice), (*_, far, _) = (with_probe((x, 0.3, 0.7), mach) for x in (60.0, 90.0))
    downwash = float(lattice.even.matrix[-1, :-1] @ gamma[:-1])
    assert (far - near) / (-30.0 * downwash) == pytest.approx(1.0, rel=0.01)


def exact_wash(rings, gamma, at, w, mach):
    """Wash at a point of the plane z = 0 by doublets that oscillate in compressible flow, both halves.

    The potential of a source is -exp[i kappa (M X - R)] / (4 pi R), R^2 = X^2 + beta^2 Y^2, kappa = w M / beta^2
    (Watkins, Runyan & Woolston, NACA Report 1234); the wake runs on with the phase exp(-i w xi).
    """
    u, weight = gauss(1)
    far, growth = gauss(40)
    behind, growth = far / (1 - far), growth / (1 - far) ** 2
    kappa, beta2, total = w * mach / (1 - mach**2), 1 - mach**2, 0.0
    nc, ns = gamma.shape
    for j in range(ns):
        edge, width = rings[0, j, 1], rings[0, j + 1, 1] - rings[0, j, 1]
        ends = rings[:, j, 0]
        cells = [(a + u * (b - a), weight * (b - a)) for a, b in pairwise(ends)]
        wake = (ends[-1] + behind, growth * np.exp(-1j * w * (behind + 0.25 / nc)))
        for (x, dx), strength in zip([*cells, wake], [*gamma[:, j], gamma[-1, j]], strict=True):
            for side in (1.0, -1.0):
                ahead = (at[0] - x)[:, None]
                r = np.sqrt(ahead**2 + beta2 * (at[1] - side * (edge + u * width)) ** 2)
                kernel = (1 + 1j * kappa * r) * np.exp(1j * kappa * (mach * ahead - r)) / r**3
                total = total + beta2 / (4 * np.pi) * strength * width * (dx @ kernel @ weight)
    return total


def gauss(pieces):
    """Gauss's rule with 24 points on each piece of 0 to 1."""
    u, weight = np.polynomial.legendre.leggauss(24)
    places = np.concatenate([((u + 1) / 2 + i) / pieces for i in range(pieces)])
    return places, np.tile(weight / 2, pieces) / pieces


@pytest.mark.parametrize("mach", [0.0, 0.6])
@pytest.mark.parametrize("at", [(-1.5, 0.4, 0.0), (1.2, 2.7, 0.0)])
def test_low_frequency_wash_is_that_of_acoustic_doublets(at, mach):
    """The wash beside and ahead of a plunging wing, against a quadrature of the exact compressible kernel."""
    w = 1e-3
    wing, rate, gamma, late, lattice = with_probe(at, mach)
    rings, place = np.asarray(wing.rings), np.asarray(lattice.collocation[-1])
    amplitude = (gamma[:-1] + 1j * w * rate[:-1]).reshape(4, 4)
    exact = exact_wash(rings, amplitude, place, w, mach)
    steady = float(lattice.even.matrix[-1, :-1] @ gamma[:-1])
    assert exact.real == pytest.approx(steady, rel=1e-3)
    assert exact.imag / w == pytest.approx(late, rel=0.005)


@pytest.mark.parametrize("at", [(-0.5, 0.3, 0.4), (0.8, 0.6, -0.5), (3.0, 2.0, 1.0)])
def test_ramp_is_the_integral_of_horseshoes(at):
    """The closed form against a quadrature over the place where the strip begins."""
    left, right = jnp.array([[0.0, 0.0, 0.0]]), jnp.array([[0.3, 1.0, 0.2]])
    u, weight = gauss(10)
    points = jnp.array(at) - jnp.asarray(u / (1 - u))[:, None] * jnp.array([1.0, 0.0, 0.0])
    expected = jnp.sum(step(points, left, right)[:, 0] * (weight / (1 - u) ** 2)[:, None], axis=0)
    # the core of the trailing lines changes both by its square
    np.testing.assert_allclose(ramp(jnp.array([at]), left, right)[0, 0], expected, rtol=1e-7)


def test_on_the_sheet_the_velocity_is_the_mean_of_both_sides():
    left, right = jnp.array([[0.0, 0.0, 0.0]]), jnp.array([[0.3, 1.0, 0.0]])
    above, on, below = ramp(jnp.array([[2.0, 0.6, h] for h in (1e-7, 0.0, -1e-7)]), left, right)[:, 0]
    assert abs(float(above[0] - below[0])) == pytest.approx(1.0, rel=1e-5)  # the jump of the potential's gradient
    np.testing.assert_allclose(on, (above + below) / 2, atol=1e-6)
    assert np.all(np.isfinite(ramp(jnp.array([[2.0, 0.0, 0.0]]), left, right)))  # behind an end of the line


def test_observed_order():
    """Each halving of the panels' chords quarters the error of CZ_alphadot, as of the steady lift."""
    a, b, c = (float(_rates([rectangle(4.0, n, 6)], 0.0)[0][1]) for n in (4, 8, 16))
    assert np.log2((b - a) / (c - b)) == pytest.approx(2.0, abs=0.2)


def test_the_wake_is_fine_and_long_enough(monkeypatch):
    """Half the step in phase, or twice the length, changes the wash of the wake by less than 0.01 %."""
    wing = rectangle(10.0, 4, 4)
    points, beta = wing.collocation.reshape(-1, 3), jnp.asarray(1.0)

    def wash():
        each = [module._oscillating_wash(points, [wing], jnp.asarray(lag), beta) for lag in (0.1, 2.0)]
        return np.stack(each)[..., 2]

    before = wash()
    size = np.max(np.abs(before), axis=(1, 2), keepdims=True)
    for name, value in (("PHASE_STEP", 0.5 * module.PHASE_STEP), ("FADE", tuple(2 * f for f in module.FADE))):
        with monkeypatch.context() as patch:
            patch.setattr(module, name, value)
            assert np.max(np.abs(wash() - before) / size) < 1e-4


@pytest.mark.parametrize("mach", [0.0, 0.5])
def test_scale_and_place(mach):
    """Coefficients depend neither on the unit of length nor on the origin of x."""
    here = np.asarray(_rates(wing_and_tail(), mach)[0])
    larger = np.asarray(_rates(wing_and_tail(scale=3.0), mach, c=3.0)[0]) / 9.0
    moved, loads, (lattice, _) = _rates(wing_and_tail(shift=7.0), mach)
    _, moment = unsteady_resultant(lattice, loads, POINT + jnp.array([7.0, 0.0, 0.0]))
    np.testing.assert_allclose(larger[:2], here[:2], rtol=1e-6)
    np.testing.assert_allclose([*moved[:2], moment[1]], here, rtol=1e-9)
    one, three = (_oscillation(wing_and_tail(scale=s), jnp.array([0.4, 1.0]) / s, mach)[0][0] for s in (1.0, 3.0))
    np.testing.assert_allclose(three / 9.0, one, rtol=1e-5)


def test_added_forces_know_their_strips():
    panels = wing_and_tail()
    lay = layout(shapes(panels))
    _, loads, (lattice, _) = _rates(panels, 0.0)
    strip = added_strips(lay)
    assert strip.shape[0] == loads.added.shape[0]
    y = np.asarray(lattice.strip_point)[strip, 1]
    half = np.asarray(lattice.strip_width)[strip] / 2
    assert np.all(np.abs(np.asarray(loads.added_points)[:, 1] - y) < half)


def test_derivatives_of_the_kernels(check_derivatives):
    def of(v):
        left, right = v[None, :3], v[None, 3:6]
        at = jnp.array([[0.7, 0.6, 0.3], [-1.0, 0.2, -0.4]]) + 0.1 * v[6]
        return jnp.concatenate([ramp(at, left, right).ravel(), step(at, left, right).ravel()])

    check_derivatives(of, [0.1, 0.2, 0.1, 0.4, 1.1, 0.2, 0.5])


def hold_derivatives(of, at, h=1e-3):
    """Forward mode against differences, relative to the largest entry of each column."""
    of, at = jax.jit(of), np.asarray(at)
    exact = np.asarray(jax.jit(jax.jacfwd(of))(at))
    for i, e in enumerate(h * np.eye(at.size)):
        wide, narrow = (of(at + f * e) - of(at - f * e) for f in (1.0, 0.5))
        size = np.max(np.abs(exact[:, i]))
        assert size > 0.0
        np.testing.assert_allclose(exact[:, i], (8 * narrow - wide) / (6 * h), atol=1e-6 * size)


def test_derivatives():
    """Of the rates by geometry and Mach number."""

    def of(v):
        return rates(wing_and_tail(chord=v[0], sweep=v[1], height=v[2], twist=0.1 * v[3]), v[4])[0]

    hold_derivatives(of, [1.0, 0.3, 0.8, 0.5, 0.5])


def test_derivatives_of_an_oscillation():
    """By geometry, frequency and Mach number."""

    def of(v):
        wing = surface([(0.0, 0.0, 0.0, 1.0, 0.0), (v[1], 2.0 * v[0], 0.1, 0.7, 0.0)], 2, 2)
        force = oscillation([wing], v[2][None], v[3])[0][0][0, 2]
        return jnp.stack([force.real, force.imag])

    hold_derivatives(of, [1.0, 0.8, 0.6, 0.4])


# Sideways.


def sideways(panels, mach, b=1.0, kinds=None):
    """[CY, Cl, Cn] by betadot b / 2V over unit area about the quarter chord, without a mean load."""
    lattice, _ = assemble(panels, mach, kinds=kinds, lateral=True)
    lay = layout(shapes(panels), kinds)
    slope = solve(lattice.odd, lattice.normal[:, 1])
    velocity = jnp.broadcast_to(jnp.array([1.0, 0.0, 0.0]), lattice.points.shape)
    given = dict(gamma=jnp.zeros_like(slope), gamma_by=slope, velocity=velocity, mach=mach, length=b)
    loads = plunge_rate(lattice, panels, lay, **given, odd=True)
    force, moment = unsteady_resultant(lattice, loads, POINT, odd=True)
    return jnp.stack([force[1], -moment[0] / b, -moment[2] / b])


_sideways = jax.jit(sideways, static_argnames="kinds")
SWEPT = ((0.0, 0.0, 1.3), (0.8, 2.0, 0.7))  # x_le, place along the span, chord


@pytest.mark.parametrize("mach", [0.0, 0.5])
def test_a_fin_is_a_wing_on_its_side(mach):
    """A wing turned by 90 degrees into the plane of symmetry, both halves: its alpha-dot is the beta-dot of the fin."""
    wing = surface([(x, y, 0.0, c, 0.0) for x, y, c in SWEPT], 2, 4)
    outwards = [(x, 0.0, y, c, 0.0) for x, y, c in SWEPT]
    fin = surface([(x, y, -z, c, t) for x, y, z, c, t in outwards[::-1]] + outwards[1:], 2, 8)
    _, lift, moment = _rates([wing], mach, mean=0.0)[0]
    side, roll, yaw = _sideways([fin], mach, kinds=(PLANE,))
    np.testing.assert_allclose([side, roll, yaw], [-lift, 0.0, -moment], rtol=1e-9, atol=1e-10)
    assert abs(float(lift)) > 0.1


@pytest.mark.parametrize("mach", [0.0, 0.5])
def test_four_equal_wings_feel_both_rates_alike(mach):
    """A cross of wings at 45 degrees, alone and with a second one behind: alpha-dot and beta-dot by the symmetry."""
    s, out = np.sqrt(0.5), []
    for shift, size in ((0.0, 1.0), (4.0, 0.5)):
        for sign in (1.0, -1.0):
            rows = [(shift + x * size, y * s * size, sign * y * s * size, c * size, 0.0) for x, y, c in SWEPT]
            out.append(surface(rows, 2, 3))
    _, lift, moment = _rates(out, mach, mean=0.0)[0]
    side, roll, yaw = _sideways(out, mach)
    np.testing.assert_allclose([side, roll, yaw], [-lift, 0.0, -moment], rtol=1e-9, atol=1e-9)
    assert abs(float(moment)) > 0.1


@pytest.mark.parametrize("mach", [0.0, 0.6])
def test_slender_fin(mach):
    """-pi AR / 3 of a slender delta in the plane of symmetry, both halves, as of the wing (slender-body theory)."""

    def ratio(ar):
        tip = 0.02
        outwards = [(0.0, 0.0, 0.0, 1.0, 0.0), (1 - tip, 0.0, ar / 4 * (1 - tip), tip, 0.0)]
        fin = surface([(x, y, -z, c, t) for x, y, z, c, t in outwards[::-1]] + outwards[1:], 24, 24, span="cosine")
        return float(_sideways([fin], mach, kinds=(PLANE,))[0]) / (ar / 4) / (-np.pi * ar / 3)

    both = [ratio(ar) for ar in (0.1, 0.05)]
    assert 2 * both[1] - both[0] == pytest.approx(1.0, abs=0.01)
