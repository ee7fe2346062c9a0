"""Wing masses of two real aircraft from their definitions, without fitting; what is not reached is marked so."""

import pytest

from hera_om.aircraft import load_aircraft
from hera_om.models import build_aircraft

SHORT = (
    "the sized box over its share of 85 % has no joints, fasteners, doublers, cut-outs or stiffeners of ribs and webs"
)


@pytest.fixture(scope="module", params=["atr72", "q400"])
def sized(request):
    problem = build_aircraft(load_aircraft(request.param))
    problem.run_model()
    return request.param, {
        n: float(problem.get_val(n)[0]) for n in ("m_wing", "m_primary", "RFC", "RFT", "m_remainder")
    }


@pytest.mark.slow
def test_caps_and_stringers_carry_their_loads_and_nothing_is_fitted(sized):
    _, found = sized
    assert found["RFC"] > 1.5 and found["RFT"] > 1.5
    assert found["m_remainder"] == 0.0
    assert found["m_wing"] == pytest.approx(found["m_primary"] / 0.85)


@pytest.mark.slow
@pytest.mark.xfail(strict=True, reason=SHORT)
def test_wing_mass_is_the_published_one(sized):
    """ATR 72: 2300 to 3050 kg between Torenbeek's formula and the redesign of FZT; Q400: 2773 kg by Torenbeek, 20 %."""
    name, found = sized
    low, high = {"atr72": (2300.0, 3050.0), "q400": (0.8 * 2773.0, 1.2 * 2773.0)}[name]
    assert low < found["m_wing"] < high
