import pytest
from openmdao.utils.units import valid_units

from hera_om.core.registry import INPUTS, OUTPUTS, REGISTRY, quantity

DESIGN_NAMES = """
alpha beta mach altitude p_hat q_hat r_hat delta_e delta_a delta_r y_kink theta_tip y_prop
htail_scale A_cap_root A_stringer_root CL CD CDi CDi_near CD_profile CD_fuselage CD_areas
CD_slipstream CX CY CZ Cl Cm Cn CT CP thrust power L_over_D cl_span x_np static_margin omega_sp
zeta_sp omega_ph zeta_ph omega_dr zeta_dr tau_roll t2_spiral CAP RFC RFT m_wing mass x_cg z_cg Ixx
Iyy Izz Ixz range_fixed_mass range_fixed_fuel range_per_energy
""".split()


def test_every_name_of_the_design_is_there_once():
    assert set(DESIGN_NAMES) <= set(REGISTRY)
    assert len(REGISTRY) == len(INPUTS) + len(OUTPUTS)
    assert all(name == q.name for name, q in REGISTRY.items())


@pytest.mark.parametrize("name", [*REGISTRY, "theta_hybrid", "Cm_alpha", "thrust_hybrid"])
def test_units_are_openmdao_units_and_meaning_is_said(name):
    q = quantity(name)
    assert q.units is None or valid_units(q.units)
    assert len(q.desc) > 8


def test_inputs_have_defaults_and_outputs_have_none():
    assert all(q.default is not None for q in INPUTS.values())
    assert all(q.default is None for q in OUTPUTS.values())


@pytest.mark.parametrize(
    ("name", "units"),
    [
        ("alpha", "deg"),
        ("omega_sp", "rad/s"),
        ("Iyy", "kg*m**2"),
        ("theta_electric", "deg"),
        ("theta_tip", "deg"),
        ("thrust_electric", "N"),
        ("power_hybrid", "W"),
        ("CT_hybrid", None),
        ("CP_hybrid", None),
        ("eta_hybrid", None),
        ("CL_alpha", "1/rad"),
        ("Cm_q", None),
        ("Cm_alphadot", None),
        ("CY_betadot", None),
        ("Cm_delta_e", "1/rad"),
        ("CZ_delta_e", "1/rad"),
        ("CX_theta_hybrid", "1/rad"),
        ("Cl_p", None),
    ],
)
def test_names_with_their_units(name, units):
    assert quantity(name).name == name
    assert quantity(name).units == units


def test_exact_name_wins_over_a_family_and_group_is_in_the_meaning():
    assert "tip" in quantity("theta_tip").desc and "rotor" not in quantity("theta_tip").desc
    assert quantity("theta_electric").desc.endswith("electric")


@pytest.mark.parametrize(
    ("name", "near"), [("alhpa", "alpha"), ("Cm_alph", "Cm_alpha"), ("static_margn", "static_margin")]
)
def test_unknown_name_gives_the_nearest(name, near):
    with pytest.raises(KeyError, match=near):
        quantity(name)


@pytest.mark.parametrize("name", ["", "theta_", "CT_1x", "CQ_alpha", "Cm_gamma", "Cm_"])
def test_what_only_looks_like_a_name_is_refused(name):
    with pytest.raises(KeyError):
        quantity(name)
