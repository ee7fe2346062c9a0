"""Pytest plugin that switches one effect of the physics off before a test is imported.

The environment variable HERA_OM_MUTATION names the row of `MUTATIONS`. `test_mutations.py` runs a validation
test in a process of its own with this plugin and expects it to fail.
"""

import importlib
import inspect
import os
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jax import lax


class Mutation(NamedTuple):
    """What is switched off, where, and the validation test that must notice."""

    effect: str
    places: tuple[str, ...]  # "module:attribute", below hera_om.physics
    change: object  # the new value, or a function of the old one when ``wrap``
    test: str
    wrap: bool = False


def _no_inertia(mass, load_factor):
    return jnp.zeros((mass.shape[0], 3))


def _half_load_factor(old):
    def inertia_load(masses, load_factor):
        return old(masses, 0.5 * load_factor)

    return inertia_load


def _without_alphadot(old):
    def matrix(derivatives, *args, **kwargs):
        still = dict(CX_alphadot=0.0, CZ_alphadot=0.0, Cm_alphadot=0.0)
        return old(derivatives._replace(**still), *args, **kwargs)

    return matrix


def _frozen(old):
    def mean_slipstreams(rotors, plan, wake, *points, **how):
        return old(rotors, plan, lax.stop_gradient(wake), *points, **how)

    return mean_slipstreams


def _mirrored_swirl(old):
    def mean_slipstreams(rotors, plan, wake, *points, **how):
        return old(rotors, plan, wake._replace(swirl=-wake.swirl), *points, **how)

    return mean_slipstreams


def _without_image(old):
    def ring_velocities(*args):
        own, image = old(*args)
        return own, jnp.zeros_like(image)

    return ring_velocities


def _unswept(old):
    def axes(*args):
        line = old(*args) * jnp.array([0.0, 1.0, 1.0])
        return line / jnp.linalg.norm(line, axis=-1, keepdims=True)

    return axes


def _no_loss(old):
    def loss(phi, *args):
        return jnp.ones_like(old(phi, *args))

    return loss


def _nothing_in_the_way(r2, radius, nacelle):
    return jnp.ones_like(r2)


def _mid_width(old):
    def span_weights(*args):
        weights, middle = old(*args)
        return weights, 0.0 * middle + 0.5

    return span_weights


def _unreversed(old):
    def both_halves(points, beta, velocity, sign=1.0):
        return old(points, beta, velocity)

    return both_halves


def _own_components(old):
    def owners(surfaces, components, others):
        return old(surfaces, range(len(components)), others)

    return owners


def _no_wake_angle(angle, beta):
    return None


def _untransferred(old):
    def axis_moments(loads, through, direction):
        return old(loads, loads.point, direction)

    return axis_moments


def _no_delay(old):
    def delayed(cl, cd, **rest):
        return cl, cd

    return delayed


def _no_swirl(old):
    def resultant(load, solidity, *args):
        return old(load._replace(tangential=0.0 * load.tangential), solidity, *args)

    return resultant


def _first_column(old):
    def weights(knots, cells, x):
        return jnp.zeros_like(old(knots, cells, x)).at[..., 0].set(1.0)

    return weights


def _isotropic_plate(old):
    def affine(f):
        return old(f._replace(across=f.along, mixed=f.along))

    return affine


def _unswept_axis(old):
    def frame(axis):
        return old(axis * jnp.array([0.0, 1.0, 1.0]))

    return frame


def _unanswered(old):
    def loads(wing, slope, *rest):
        return old(wing, 0.0 * slope, *rest)

    return loads


def _other_cover(old):
    def use(*args):
        caller = inspect.stack()[1].function
        return -old(*args) if caller == "thin" else old(*args)

    return use


def _half_factors(old):
    def matrix(weights, *, limit_factor, **rest):
        return old(weights, limit_factor=0.5 * limit_factor, **rest)

    return matrix


def _without_rear_spar(old):
    def properties(shape, other, t):
        return old(shape, other, t.at[3].multiply(1e-6))

    return properties


def _starboard_alone(old):
    calls = []

    def steps(strength):
        calls.append(None)
        return old(strength) * (len(calls) % 2)

    return steps


def _nothing(old):
    return lambda *args, **how: jax.tree.map(jnp.zeros_like, old(*args, **how))


PHYSICS = "tests/physics/"
BLOWN = f"{PHYSICS}test_aerodynamics.py::"
TUNNEL = "tests/components/test_propeller_wing.py::"
PENALISED = "tests/components/test_wingbox_component.py::test_a_wing_without_a_given_share_is_built_up"
SLIPSTREAMS = ("coupling:mean_slipstreams",)
MUTATIONS = {
    "slipstream_off": Mutation(
        "slipstream on the surfaces",
        ("coupling:SLIPSTREAM", "aerodynamics:SLIPSTREAM"),
        0.0,
        BLOWN + "test_the_slipstream_raises_the_lift_slope_where_the_wing_is_immersed",
    ),
    "swirl_flipped": Mutation(
        "sign of the swirl",
        SLIPSTREAMS,
        _mirrored_swirl,
        BLOWN + "test_the_sense_of_rotation_decides_which_side_of_the_hub_is_lifted",
        True,
    ),
    "slipstream_off_in_the_tunnel": Mutation(
        "slipstream on surfaces",
        ("coupling:SLIPSTREAM", "aerodynamics:SLIPSTREAM"),
        0.0,
        TUNNEL + "test_model_I",
    ),
    "swirl_flipped_before_dust": Mutation(
        "sign of the swirl", SLIPSTREAMS, _mirrored_swirl, TUNNEL + "test_the_dipole_of_dust", wrap=True
    ),
    "finite_jet_off_in_both_senses": Mutation(
        "edges of the jets", ("coupling:FINITE_JET",), 0.0, TUNNEL + "test_model_I_in_both_senses"
    ),
    "finite_jet_off": Mutation("edges of the jets", ("coupling:FINITE_JET",), 0.0, TUNNEL + "test_model_II"),
    "edges_unanswered": Mutation(
        "answer of a jet's edges to the wing",
        ("finite_jet:edge_answer",),
        _nothing,
        PHYSICS + "test_round_jet.py::test_lift_of_a_wing_through_round_jets[shape2-0.5-1.2-0.04]",
        wrap=True,
    ),
    "trailing_unanswered": Mutation(
        "answer of a jet's edges to what trails",
        ("finite_jet:trailing_answer",),
        _nothing,
        PHYSICS + "test_round_jet.py::test_lift_of_a_load_that_changes_within_a_jet[shape0-inside-0.25]",
        wrap=True,
    ),
    "half_a_vortex": Mutation(
        "more than half of that answer behind the lift",
        ("finite_jet:LEG_SHARE",),
        1e6,
        PHYSICS + "test_finite_jet.py::test_answer_to_what_trails[0.3-0.1]",
    ),
    "steps_apart": Mutation(
        "what edges do to each other",
        ("finite_jet:_together",),
        lambda old: lambda k, r, share=1.0: old(k, r, 0.0),
        PHYSICS + "test_finite_jet.py::test_steps_in_a_row_answer_as_one_to_what_is_far_away",
        wrap=True,
    ),
    "port_images_off": Mutation(
        "vortices of the other half in a jet across the plane of symmetry",
        ("strips:_steps",),
        _starboard_alone,
        PHYSICS + "test_strips.py::test_without_an_image_the_other_half_is_not_there",
        wrap=True,
    ),
    "thickness_off": Mutation("flow of thickness at the disks", ("coupling:THICKNESS",), 0.0, TUNNEL + "test_model_II"),
    "inflow_turn_off": Mutation(
        "turn of slipstreams by what other parts do at the disk",
        ("disks:INFLOW_TURN",),
        0.0,
        PHYSICS + "test_disks_coupling.py::test_upwash_of_others_turns_a_slipstream_as_incidence_does",
    ),
    "turn_off": Mutation(
        "turn of slipstreams by forces across the shaft",
        ("slipstream:TURN",),
        0.0,
        PHYSICS + "test_slipstream.py::test_a_force_across_the_shaft_is_the_momentum_far_behind[2.0-0.01]",
    ),
    "nacelle_off": Mutation(
        "nacelle in the slipstream",
        ("slipstream:beside_nacelle",),
        _nothing,
        PHYSICS + "test_slipstream.py::test_a_nacelle_pushes_the_tube_outwards",
        wrap=True,
    ),
    "nacelle_passed_through": Mutation(
        "nacelle in the way of the slipstream's drift",
        ("slipstream:past_nacelle", "disks:past_nacelle"),
        _nothing_in_the_way,
        TUNNEL + "test_model_II",
    ),
    "nacelle_flow_off": Mutation(
        "flow of a nacelle at its own disk",
        ("nacelle:NACELLE",),
        0.0,
        PHYSICS + "test_rotor_measured.py::test_naca_propeller[25-0.7-0.006-0.006]",
    ),
    "skew_off": Mutation(
        "turn of the slipstream's middle towards the stream",
        ("slipstream:SKEW",),
        0.0,
        PHYSICS + "test_slipstream.py::test_the_tube_follows_the_stream_and_turns_with_it",
    ),
    "crossflow_off": Mutation(
        "turn of the air in a slipstream at an angle to its shaft",
        ("slipstream:CROSSFLOW",),
        0.0,
        TUNNEL + "test_model_II",
    ),
    "senses_swapped": Mutation(
        "names of the senses of rotation",
        ("rotor_blade:SENSES",),
        {"inboard-up": 1.0, "outboard-up": -1.0},
        BLOWN + "test_the_sense_of_rotation_decides_which_side_of_the_hub_is_lifted",
    ),
    "slipstream_frozen": Mutation(
        "response of the slipstream in the derivatives",
        SLIPSTREAMS,
        _frozen,
        BLOWN + "test_power_on_derivatives_hold_the_response_of_the_slipstream",
        True,
    ),
    "upwash_off": Mutation(
        "upwash of the surfaces at the disks",
        ("coupling:UPWASH",),
        0.0,
        PHYSICS + "test_disks_coupling.py::test_upwash_of_the_wing_loads_the_disk",
    ),
    "neighbours_off": Mutation(
        "slipstream of a rotor at another's disk",
        ("coupling:NEIGHBOURS",),
        0.0,
        PHYSICS + "test_disks_coupling.py::test_a_rotor_behind_another_works_in_its_slipstream",
    ),
    "prandtl_glauert_off": Mutation(
        "compressibility",
        ("lattice:prandtl_glauert",),
        jnp.ones_like,
        PHYSICS + "test_lattice.py::test_compressible_slope",
    ),
    "prandtl_glauert_off_avl": Mutation(
        "compressibility, against AVL",
        ("lattice:prandtl_glauert",),
        jnp.ones_like,
        BLOWN + "test_avl_wing_and_tail[base_m04]",
    ),
    "alphadot_zero": Mutation(
        "lag of the wake in alpha-dot",
        ("unsteady_lattice:WAKE_LAG",),
        0.0,
        BLOWN + "test_alphadot_holds_the_classical_lag_of_downwash",
    ),
    "wake_lag_off": Mutation(
        "lag of the wake at any frequency",
        ("unsteady_lattice:WAKE_LAG",),
        0.0,
        PHYSICS + "test_unsteady_lattice.py::test_theodorsen_function",
    ),
    "apparent_mass_off": Mutation(
        "apparent mass",
        ("unsteady_lattice:APPARENT_MASS",),
        0.0,
        PHYSICS + "test_unsteady_lattice.py::test_theodorsen_function",
    ),
    "compressible_phase_off": Mutation(
        "phase of compressible waves in unsteady flow",
        ("unsteady_lattice:COMPRESSIBLE_PHASE",),
        0.0,
        PHYSICS + "test_unsteady_lattice.py::test_low_frequency_wash_is_that_of_acoustic_doublets",
    ),
    "apparent_mass_off_sideways": Mutation(
        "apparent mass in beta-dot",
        ("unsteady_lattice:APPARENT_MASS",),
        0.0,
        PHYSICS + "test_unsteady_lattice.py::test_slender_fin",
    ),
    "images_of_wakes_unreversed": Mutation(
        "sign of the wakes' images in beta-dot",
        ("unsteady_lattice:_both_halves",),
        _unreversed,
        PHYSICS + "test_unsteady_lattice.py::test_four_equal_wings_feel_both_rates_alike",
        True,
    ),
    "conditions_at_mid_width": Mutation(
        "conditions at the middle of the spanwise law",
        ("geometry:span_weights",),
        _mid_width,
        PHYSICS + "test_lattice_order.py::test_order_along_the_span",
        True,
    ),
    "wake_stays_along_x": Mutation(
        "direction of a wake along the stream",
        ("lattice:_direction",),
        _no_wake_angle,
        PHYSICS + "test_lattice_invariants.py::test_pitch_of_geometry_and_stream_together",
    ),
    "components_apart": Mutation(
        "surfaces of one component without cores between them",
        ("lattice:_owners",),
        _own_components,
        PHYSICS + "test_lattice_invariants.py::test_a_surface_split_in_two",
        True,
    ),
    "pressure_over_panels": Mutation(
        "area that the pressure of a bound line belongs to",
        ("lattice_forces:pressure_cells",),
        lambda mesh, rear: mesh,
        PHYSICS + "test_lattice_forces.py::test_pressure_of_a_flat_plate",
    ),
    "axis_moments_untransferred": Mutation(
        "transfer of strip moments to an axis",
        ("lattice_forces:axis_moments",),
        _untransferred,
        PHYSICS + "test_lattice_forces.py::test_moments_about_any_axis_are_those_of_the_filaments",
        True,
    ),
    "cores_off": Mutation(
        "cores of vortices between components, against AVL",
        ("lattice:CORE_WIDTHS",),
        1e-6,
        "tests/components/test_avl_case.py::test_every_number_of_avl",
    ),
    "prandtl_glauert_off_avl_file": Mutation(
        "compressibility, against AVL from its own file",
        ("lattice:prandtl_glauert",),
        jnp.ones_like,
        "tests/components/test_avl_case.py::test_every_number_of_avl",
    ),
    "image_off": Mutation(
        "mirror image of the other half",
        ("lattice:ring_velocities",),
        _without_image,
        BLOWN + "test_avl_wing_and_tail[base_m04]",
        True,
    ),
    "image_off_in_blocks": Mutation(
        "mirror image of the other half, where influence is found in blocks",
        ("lattice:EVEN",),
        (1.0, 0.0),
        PHYSICS + "test_lattice.py::test_bertin",
    ),
    "hinge_sweep_off": Mutation(
        "sweep of the hinge line",
        ("controls:_axes",),
        _unswept,
        "tests/components/test_avl_case.py::test_every_number_of_avl",
        True,
    ),
    "body_shield_off": Mutation(
        "shield of the fuselage",
        ("slender_body:SHIELD",),
        0.0,
        PHYSICS + "test_slender_body.py::test_no_flow_inside_and_nothing_off_the_body",
    ),
    "body_upwash_off_whole": Mutation(
        "upwash of the fuselage at wing and tail",
        ("slender_body:UPWASH",),
        0.0,
        "tests/components/test_slender_fuselage.py::test_lift_slope_of_wing_and_body",
    ),
    "body_upwash_off": Mutation(
        "upwash of the fuselage",
        ("slender_body:UPWASH",),
        0.0,
        PHYSICS + "test_slender_body.py::test_upwash_of_a_cylinder",
    ),
    "modes_without_alphadot": Mutation(
        "alpha-dot terms in the equations of motion",
        ("flight_dynamics:longitudinal_state_matrix",),
        _without_alphadot,
        PHYSICS + "test_flight_dynamics.py::test_boeing_modes_from_its_derivatives",
        True,
    ),
    "tip_loss_off": Mutation(
        "losses at tip and hub of the blade",
        ("rotor:prandtl_loss",),
        _no_loss,
        PHYSICS + "test_rotor.py::test_ccblade_propeller",
        True,
    ),
    "tip_loss_off_table": Mutation(
        "losses at tip and hub of the blade, polar from a table",
        ("rotor:prandtl_loss",),
        _no_loss,
        PHYSICS + "test_rotor_measured.py::test_ccblade_propeller_with_its_own_table",
        True,
    ),
    "tip_loss_off_measured": Mutation(
        "losses at tip and hub of the blade, against the wind tunnel",
        ("rotor:prandtl_loss",),
        _no_loss,
        PHYSICS + "test_rotor_measured.py::test_naca_propeller[35-1.2-0.008-0.009]",
        True,
    ),
    "rotor_swirl_off": Mutation(
        "swirl in the resultant speed at the blade",
        ("rotor:_resultant_speed",),
        _no_swirl,
        PHYSICS + "test_rotor.py::test_analytic_propeller",
        True,
    ),
    "turbulent_wake_off": Mutation(
        "turbulent wake state of a braking rotor",
        ("rotor_momentum:TURBULENT_WAKE",),
        0.0,
        PHYSICS + "test_rotor.py::test_momentum_and_turbulent_wake_states",
    ),
    "stall_delay_off": Mutation(
        "delay of stall by rotation",
        ("rotor:delayed",),
        _no_delay,
        PHYSICS + "test_windmilling.py::test_stall_delay_raises_the_thrust_of_a_stalled_root",
        True,
    ),
    "blade_reynolds_and_mach_off": Mutation(
        "Reynolds and Mach number in the polars of blades",
        ("blade_polar:_axis_weights",),
        _first_column,
        PHYSICS + "test_blade_polar.py::test_table_between_its_points",
        True,
    ),
    "relief_off": Mutation(
        "inertia relief",
        ("beam_loads:inertia_forces",),
        _no_inertia,
        PHYSICS + "test_beam_loads.py::test_masses_relieve_and_an_engine_farther_out_relieves_more",
    ),
    "load_factor_halved": Mutation(
        "load factor of the relief",
        ("beam_loads:inertia_load",),
        _half_load_factor,
        PHYSICS + "test_beam_loads.py::test_masses_relieve_and_an_engine_farther_out_relieves_more",
        True,
    ),
    "buckling_off": Mutation(
        "buckling of the covers",
        ("wingbox_criteria:cover_buckling_use",),
        _nothing,
        PHYSICS + "test_wingbox.py::test_torsion_alone_sizes_as_shear_buckling_by_hand",
        True,
    ),
    "web_buckling_off": Mutation(
        "buckling of the webs",
        ("wingbox_criteria:web_buckling_use",),
        _nothing,
        PHYSICS + "test_wingbox.py::test_torsion_alone_sizes_as_shear_buckling_by_hand",
        True,
    ),
    "brazier_off": Mutation(
        "crushing of ribs by the curvature of the bent box",
        ("buckling:brazier_pressure",),
        lambda stress, *args, **rest: 0.0 * stress,
        PHYSICS + "test_wingbox.py::test_ribs_carry_the_crushing_load_by_hand",
    ),
    "brazier_off_in_skins": Mutation(
        "crushing of skins by the curvature of the bent box",
        ("buckling:brazier_pressure",),
        lambda stress, *args, **rest: 0.0 * stress,
        PHYSICS + "test_wingbox.py::test_thin_skins_between_wide_stringers_are_sized_by_crushing",
    ),
    "rear_spar_removed": Mutation(
        "one of two spars",
        ("box_section:section_properties", "box_section:shear_flow"),
        _without_rear_spar,
        PHYSICS + "test_box_section.py::test_sections_against_finite_elements[root_43018]",
        True,
    ),
    "tsai_wu_without_interaction": Mutation(
        "interaction of stresses along and across the fibres",
        ("laminate:INTERACTION",),
        0.0,
        PHYSICS + "test_laminate.py::test_first_ply_failure_as_printed",
    ),
    "tsai_wu_off_in_the_sheets": Mutation(
        "failure of plies in shear",
        ("laminate:shear_use",),
        lambda laminate, direct, shear: 1e-3 + 0.0 * laminate.linear[:, :1, None, None, None] * direct,
        PHYSICS + "test_laminate.py::test_torsion_alone_asks_for_the_shear_strength_of_the_ply",
    ),
    "orthotropy_off_in_plates": Mutation(
        "twisting stiffness of orthotropic plates",
        ("laminate:_affine",),
        _isotropic_plate,
        PHYSICS + "test_laminate.py::test_compression_of_a_specially_orthotropic_plate[1.3]",
        True,
    ),
    "sweep_off_in_the_elastic_wing": Mutation(
        "incidence that a bent swept wing loses",
        ("aeroelastic:axis_frame",),
        _unswept_axis,
        PHYSICS + "test_aeroelastic.py::test_sweep_back_relieves_and_sweep_forward_loads",
        True,
    ),
    "twist_does_not_lift": Mutation(
        "lift by the twist of an elastic wing",
        ("aeroelastic:elastic_loads",),
        _unanswered,
        PHYSICS + "test_aeroelastic.py::test_twist_of_a_straight_wing[0.7]",
        True,
    ),
    "section_not_turned": Mutation(
        "incidence of the sections of the box",
        ("wingbox_types:on_sections",),
        lambda loads, incidence: loads,
        PHYSICS + "test_box_section.py::test_a_turned_section_by_hand[0.08]",
    ),
    "wrong_cover_spared": Mutation(
        "which cover is not thickened for the sake of its stringers",
        ("wingbox_reserve:cover_compression",),
        _other_cover,
        PHYSICS + "test_wingbox.py::test_no_random_wing_that_is_bought_has_a_lower_reserve",
        True,
    ),
    "relief_off_in_the_mass": Mutation(
        "inertia relief, in the mass of the wing",
        ("beam_loads:inertia_forces",),
        _no_inertia,
        "tests/components/test_wingbox_component.py::test_shear_and_bending_at_the_joint_by_hand",
    ),
    "load_factor_halved_in_the_cases": Mutation(
        "load factor of the table of cases",
        ("load_cases:case_matrix",),
        _half_factors,
        PHYSICS + "test_load_cases.py::test_the_table_of_cases",
        True,
    ),
    "steady_gust": Mutation(
        "growth of lift in a gust",
        ("gust:KUESSNER",),
        np.array([[0.0, 0.13], [0.0, 1.0]]),
        PHYSICS + "test_load_cases.py::test_alleviation_is_pratts_at_his_gradient[20.0]",
    ),
    "net_section_off": Mutation(
        "holes and notches of fasteners in tension",
        ("wingbox_criteria:tension_allowable",),
        lambda material: material.F_tu,
        PHYSICS + "test_wingbox.py::test_reserves_are_allowable_over_limit_stress",
    ),
    "cap_crippling_off": Mutation(
        "crippling of thin caps",
        ("buckling:NEEDHAM_FACTOR",),
        1e3,
        PHYSICS + "test_wingbox.py::test_thin_caps_cripple_before_they_yield",
    ),
    "penalties_off": Mutation(
        "joints, holes, attachments and stiffness in the mass of the wing",
        ("wing_build_up:box_penalties",),
        _nothing,
        PENALISED,
        True,
    ),
    "secondary_structure_off": Mutation(
        "secondary structure in the mass of the wing",
        ("wing_build_up:secondary_structure",),
        _nothing,
        PENALISED,
        True,
    ),
    "wing_stiffness_off": Mutation(
        "penalty for torsional stiffness",
        ("wing_build_up:STIFFNESS",),
        0.0,
        PHYSICS + "test_wing_build_up.py::test_torenbeeks_older_equations_ask_for_as_much",
    ),
    "joints_off": Mutation(
        "penalty for joints",
        ("wing_build_up:JOINTS",),
        0.0,
        PHYSICS + "test_wing_build_up.py::test_torenbeeks_older_equations_ask_for_as_much",
    ),
    "gyroscopes_off": Mutation(
        "gyroscopic moment of rotors",
        ("load_cases:gyroscopic_moment",),
        lambda inertia, spin, rate: 0.0 * spin,
        PHYSICS + "test_load_cases.py::test_landing_and_gyroscopes_by_hand",
    ),
}


def apply(name: str) -> None:
    """Change the attributes of the modules; those that test modules import by name must not have been
    imported.
    """
    mutation = MUTATIONS[name]
    for place in mutation.places:
        module_name, attribute = place.split(":")
        module = importlib.import_module(f"hera_om.physics.{module_name}")
        old = getattr(module, attribute)
        setattr(module, attribute, mutation.change(old) if mutation.wrap else mutation.change)


def pytest_sessionstart(session):
    """Pytest's hook: after jaxtyping watches the imports, before any test module is imported."""
    if name := os.environ.get("HERA_OM_MUTATION"):
        apply(name)
