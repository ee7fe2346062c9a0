"""Polar tables of blades from the definition to the loads of a rotor."""

from importlib import resources

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from hera_om.aircraft import definition_hash, dumps, loads, numbers
from hera_om.components import arrays
from hera_om.core.errors import InputError
from hera_om.physics import blade_polar as bp
from hera_om.physics import polar_extension as pe
from hera_om.physics.aero_cases import Flow
from hera_om.physics.disks import rotor_loads

TEXT = (resources.files("hera_om.aircraft") / "data" / "wing_rotor.toml").read_text("utf-8")
HEAD = """name = "props"
[flight]
mach = 0.0
speed_m_s = 110.04
density_kg_m3 = 1.225
[lattice]
rotor_radial = {n}
rotor_azimuthal = 4
"""
ROTOR = """
[[rotor]]
name = "{name}"
y_m = {y}
x_m = 0.0
z_m = 0.0
diameter_m = 3.93
blades = 6
rpm = 1200.0
beta75_deg = 38.0
blade = "{name}"
"""
BLADE = TEXT[TEXT.index("[[blade]]") : TEXT.index("[blade.polar]")]


def csv(alpha, reynolds, cl, cd, mach=0.0):
    """A table as text; coefficients [na, nre]."""
    rows = [
        f"{a!r},{re!r},{mach!r},{float(cl[i, j])!r},{float(cd[i, j])!r}"
        for i, a in enumerate(map(float, alpha))
        for j, re in enumerate(map(float, reynolds))
    ]
    return "\n".join(["alpha_deg,reynolds,mach,cl,cd", *rows])


def aircraft(tables, n=4, more="", keys=""):
    """Rotors side by side, one for each table; with more keys of all blades, and of their tables."""
    text = HEAD.format(n=n)
    for i, (name, table) in enumerate(tables.items()):
        blade = BLADE.replace('name = "prop"', f'name = "{name}"')
        polar = TEXT[TEXT.index("[blade.polar]") :]
        if table is not None:
            polar = f'[blade.polar_table]\n{keys}csv = """\n{table}"""\n'
        text += ROTOR.format(name=name, y=2.5 + 5.0 * i) + blade + more + polar
    return loads(text)


def solved(definition, speed, pitch=38.0):
    """Loads of the rotors of one side in axial flow."""
    plan, rotors = arrays.plan(definition, True), arrays.rotors(definition)
    velocity = jnp.zeros((1, len(plan.groups), plan.radial, plan.azimuthal, 3)).at[..., 0].set(speed)
    flow = Flow(speed, 1.225, 340.0, 1.79e-5, 0.0, jnp.zeros(3))
    angle = jnp.full(len(definition.rotor), np.radians(pitch))
    return jax.jit(lambda v, a: rotor_loads(rotors, plan, v, pitch=a, flow=flow))(velocity, angle)


def read(path):
    rows = [line.split(",") for line in path.read_text().splitlines() if line and not line.startswith("#")]
    return np.array([[float(v) for v in row] for row in rows[1:]])


@pytest.fixture(scope="module")
def clark_y(reference):
    """NeuralFoil's Clark Y: incidences (deg), Reynolds numbers, coefficients."""
    data = read(reference / "clark_y_neuralfoil.csv")
    reynolds, alpha = np.unique(data[:, 0]), np.unique(data[:, 1])
    cl, cd = (data[:, i].reshape(len(reynolds), len(alpha)).T for i in (2, 3))
    return alpha, reynolds, cl, cd


def test_ccblade_propeller_from_the_definition(reference):
    """CT and CP of CCBlade within 1 %, its own table over full incidence in the definition."""
    polar = read(reference / "atr_like" / "prop_polar.csv")
    table = csv(polar[:, 0], [1e6], polar[:, 1:2], polar[:, 2:3])
    definition = aircraft({"prop": table}, n=40)
    assert definition.blade[0].polar_table.aspect_ratio is None  # nothing to extend
    for J, CT, CP, _ in read(reference / "atr_like" / "bemt_propeller.csv"):
        found = solved(definition, J * 20.0 * 3.93)
        np.testing.assert_allclose([found.CT[0, 0], found.CP[0, 0]], [CT, CP], rtol=0.01, atol=1e-3)


def test_a_short_table_is_continued_and_extended(clark_y):
    """Mach numbers by Prandtl and Glauert, then incidences by Viterna and Corrigan for R/c at 75 % of the radius."""
    alpha, reynolds, cl, cd = clark_y
    definition = aircraft({"prop": csv(*clark_y)})
    table = definition.blade[0].polar_table
    assert table.aspect_ratio == pytest.approx(2.0 / (0.144 + 0.130))
    mach = (0.0, 0.2, 0.4, 0.5, 0.6, 0.7)
    whole = pe.full_incidence(*pe.with_mach_numbers(np.radians(alpha), cl, cd, mach), aspect_ratio=table.aspect_ratio)
    expected = bp.make_blade_table(whole[0], reynolds, mach, cl=whole[1], cd=whole[2])
    found = arrays.rotors(definition).polar
    for field in ("alpha", "log_re", "mach", "lines"):
        np.testing.assert_allclose(getattr(found, field)[0], getattr(expected, field), rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(found.cells[0], expected.cells, atol=1e-8 * np.max(np.abs(expected.cells)))


def test_what_is_loaded_is_complete(clark_y):
    definition = aircraft({"prop": csv(*clark_y)})
    assert loads(dumps(definition)) == definition
    assert not any("polar_table" in path for path in numbers(definition))
    other = aircraft({"prop": csv(clark_y[0], clark_y[1], clark_y[2], 1.1 * clark_y[3])})
    assert definition_hash(other) != definition_hash(definition)


def test_tables_of_different_incidences_stack(clark_y):
    """Each rotor has the loads that it has alone."""
    flat = np.degrees(np.linspace(-0.2, 0.25, 12))
    thin = csv(flat, [1e6], 0.1 * flat[:, None], 0.008 + 1e-4 * flat[:, None] ** 2)
    both = solved(aircraft({"clark": csv(*clark_y), "thin": thin}), 90.0)
    for i, (name, table) in enumerate({"clark": csv(*clark_y), "thin": thin}.items()):
        alone = solved(aircraft({name: table}), 90.0)
        np.testing.assert_allclose(both.force[0, i], alone.force[0, 0], rtol=1e-6, atol=1e-6)
        np.testing.assert_allclose(both.torque[0, i], alone.torque[0, 0], rtol=1e-6)
    assert abs(float(both.thrust[0, 0] - both.thrust[0, 1])) > 10.0


def test_stall_delay_of_the_definition(clark_y):
    """At a low speed the root stalls: its delay raises the thrust of the rotor, and only then."""
    plain, delayed = (aircraft({"prop": csv(*clark_y)}, more=more) for more in ("", "stall_delay = true\n"))
    assert (arrays.plan(plain, True).stall_delay, arrays.plan(delayed, True).stall_delay) == (False, True)
    slow = [float(solved(d, 15.0).thrust[0, 0]) for d in (plain, delayed)]
    fast = [float(solved(d, 110.0).thrust[0, 0]) for d in (plain, delayed)]
    assert slow[1] > 1.02 * slow[0]
    assert fast[1] == pytest.approx(fast[0], rel=0.01)


LATER = "compressible = false\n"
OTHER = ",1000000.0,", ",1200000.0,"
FAULTS = {
    "kinds": (lambda t: {"a": t, "b": None}, "", "blade.b", "polar", "polar_table as in blade a"),
    "losses": (lambda t: {"a": t, "b": t}, None, "blade.b.tip_loss", False, "true as in blade a"),
    "axes": (lambda t: {"a": t, "b": t.replace(*OTHER)}, "", "blade.b.polar_table.reynolds", "", "1e+06"),
}


@pytest.mark.parametrize("name", FAULTS)
def test_blades_that_do_not_go_together(name, clark_y):
    tables, more, key, value, expected = FAULTS[name]
    text = None
    if more is None:
        text = dumps(aircraft(tables(csv(*clark_y)))).replace("tip_loss = true", "tip_loss = false")
        text = text.replace("tip_loss = false", "tip_loss = true", 1)
    with pytest.raises(InputError) as caught:
        loads(text) if text else aircraft(tables(csv(*clark_y)))
    (problem,) = caught.value.problems
    assert problem.key == key and expected in problem.expected
    assert problem.value == value or not value


def test_tables_that_cannot_be_extended():
    alpha = np.array([-100.0, -50.0, 0.0, 50.0, 100.0])
    with pytest.raises(InputError, match=r"csv: alpha_deg: got '-100 to 100', expected ends between 1 and 90"):
        aircraft({"prop": csv(alpha, [1e6], 0.01 * alpha[:, None], 0.1 + 0.0 * alpha[:, None])}, keys=LATER)
    alpha = np.linspace(-180.0, 180.0, 9)
    lift = np.sin(np.radians(alpha))[:, None] + 0.001 * alpha[:, None]
    with pytest.raises(InputError, match=r"csv: cl: got 'differs', expected the value at alpha_deg = -180 again"):
        aircraft({"prop": csv(alpha, [1e6], lift, 0.1 + 0.0 * lift)})
    alpha = np.array([-1.2, 0.0, 2.0, 4.0])
    with pytest.raises(InputError, match=r"also 1.4 times nearer to zero lift \(compressible\)"):
        aircraft({"prop": csv(alpha, [1e6], 0.1 * alpha[:, None], 0.01 + 0.0 * alpha[:, None])})
