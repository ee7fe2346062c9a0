"""Test functions with their boxes, and one small trained set that several files share."""

from typing import NamedTuple

import numpy as np
import pytest

from hera_om import surrogates


class Function(NamedTuple):
    """A test function of rows of inputs, its box, and how many samples it is trained on."""

    call: object
    lower: tuple[float, ...]
    upper: tuple[float, ...]
    n: int

    def samples(self, n: int | None = None, seed: int = 1):
        x = surrogates.latin_hypercube(n or self.n, self.lower, self.upper, seed)
        return x, self.call(x)

    def unseen(self, n: int = 200):
        x = surrogates.sobol(n, self.lower, self.upper, 5)
        return x, self.call(x)


def branin(x):
    a, b = x[:, 0], x[:, 1]
    hill = b - 5.1 * a**2 / (4 * np.pi**2) + 5 * a / np.pi - 6
    return hill**2 + 10 * (1 - 1 / (8 * np.pi)) * np.cos(a) + 10


def wing_weight(x):
    s, fuel, aspect, sweep, q, taper, tc, nz, gross, paint = x.T
    sweep = np.deg2rad(sweep)
    box = 0.036 * s**0.758 * fuel**0.0035 * (aspect / np.cos(sweep) ** 2) ** 0.6 * q**0.006 * taper**0.04
    return box * (100 * tc / np.cos(sweep)) ** -0.3 * (nz * gross) ** 0.49 + s * paint


def forrester(x):
    return (6 * x[:, 0] - 2) ** 2 * np.sin(12 * x[:, 0] - 4)


def rosenbrock(x):
    return 100 * (x[:, 1] - x[:, 0] ** 2) ** 2 + (1 - x[:, 0]) ** 2


def lift(x):
    """A lift coefficient of ten inputs: angle, elevator, rotors, shape of the wing, tail, Mach, height."""
    alpha, delta, hybrid, electric, kink, tip, prop, tail, mach, height = x.T
    glauert = 1 / np.sqrt(1 - mach**2)
    thrust = 0.1 * np.tanh(hybrid - 4) + 0.08 * (electric / 10) ** 2 * np.exp(-2 * mach) - 1e-6 * height
    blown = 1 + 0.5 * thrust * np.exp(-2 * (prop / 10 - 0.5) ** 2)
    wing = 2 * np.pi * glauert / (1 + glauert / 6) * np.deg2rad(alpha + 0.6 * tip * (1 - kink / 30)) * blown
    return 0.3 + wing + 0.5 * tail * np.deg2rad(delta)


FUNCTIONS = {
    "branin": Function(branin, (-5.0, 0.0), (10.0, 15.0), 80),
    "wing weight": Function(
        wing_weight,
        (150.0, 220.0, 6.0, -10.0, 16.0, 0.5, 0.08, 2.5, 1700.0, 0.025),
        (200.0, 300.0, 10.0, 10.0, 45.0, 1.0, 0.18, 6.0, 2500.0, 0.08),
        120,
    ),
    "forrester": Function(forrester, (0.0,), (1.0,), 15),
    "rosenbrock": Function(rosenbrock, (-2.0, -1.0), (2.0, 3.0), 60),
    "lift": Function(
        lift,
        (-4.0, -20.0, 3.0, 8.0, 4.0, -4.0, 3.0, 0.7, 0.2, 0.0),
        (10.0, 20.0, 7.0, 14.0, 9.0, 4.0, 10.0, 1.3, 0.5, 8000.0),
        150,
    ),
}


@pytest.fixture(scope="session")
def functions() -> dict[str, Function]:
    return FUNCTIONS


def discipline(x):
    """Two inputs; a drag, a moment through zero, a side force that never acts, a thrust, a span load.

    The thrust depends on one input far more than on the other, which Kriging learns and an RBF does not.
    """
    alpha, delta = np.deg2rad(x.T)
    thrust = 0.1 * np.sin(0.8 * x[:, 0]) + 1e-4 * x[:, 1]
    station = np.linspace(0.0, 1.0, 7)
    cl = 0.2 + 5.5 * alpha + 0.4 * delta
    load = cl[:, None] * np.sqrt(1 - station**2) + np.sin(3 * alpha)[:, None] * station * (1 - station)
    moment = 0.05 - 1.1 * alpha - 1.5 * delta + alpha**2
    return np.column_stack([0.02 + cl**2 / 30, moment, np.zeros(len(x)), thrust, load])


CASE = dict(
    input_names=("alpha", "delta_e"),
    input_units=("deg", "deg"),
    output_names=("CD", "Cm", "CY", "CT", "cl_span"),
    output_units=(None, None, None, None, "m"),
    output_sizes=(1, 1, 1, 1, 7),
    lower=(-4.0, -20.0),
    upper=(10.0, 20.0),
    definition_hash="abc123",
)


@pytest.fixture(scope="session")
def case():
    """Arguments of `train` for the small discipline, as fresh arrays."""

    def arguments(**changes):
        x = surrogates.latin_hypercube(30, CASE["lower"], CASE["upper"], 1)
        x_test = surrogates.sobol(16, CASE["lower"], CASE["upper"], 2)
        given = dict(CASE, x=x, y=discipline(x), x_test=x_test, y_test=discipline(x_test), seed=3)
        return given | changes

    return arguments


@pytest.fixture(scope="session")
def small(case) -> surrogates.SurrogateSet:
    return surrogates.train(**case())
