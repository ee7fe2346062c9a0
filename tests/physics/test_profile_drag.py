"""Skin friction against published values; the parabolic polar."""

import jax.numpy as jnp
import numpy as np
import pytest

from hera_om.physics.profile_drag import section_profile_drag, turbulent_skin_friction

WING = {"cd_min": 0.0068, "cl_at_cd_min": 0.30, "k": 0.0060, "re_ref": 1.0e7}


@pytest.mark.parametrize("reynolds", [1e6, 1e7, 1e8, 1e9])
def test_against_the_implicit_law_of_schoenherr(reynolds):
    # Karman-Schoenherr, 0.242 / sqrt(Cf) = log10(Re Cf): another fit of the same measurements, within 3 %
    lower, upper = 1e-4, 1e-1
    for _ in range(200):
        middle = np.sqrt(lower * upper)
        lower, upper = (lower, middle) if 0.242 / np.sqrt(middle) < np.log10(reynolds * middle) else (middle, upper)
    np.testing.assert_allclose(turbulent_skin_friction(reynolds), middle, rtol=0.03)


def test_printed_values_of_prandtl_and_schlichting():
    # Schlichting, Boundary-Layer Theory, table of the drag of the flat plate: 1000 Cf = 4.47, 3.00, 2.13
    np.testing.assert_allclose(
        turbulent_skin_friction(jnp.asarray([1e6, 1e7, 1e8])), [4.47e-3, 3.00e-3, 2.13e-3], rtol=3e-3
    )


def test_mach_lowers_friction_by_the_printed_factor():
    ratio = turbulent_skin_friction(1e7, 0.8) / turbulent_skin_friction(1e7, 0.0)
    np.testing.assert_allclose(ratio, 1.0 / (1.0 + 0.144 * 0.64) ** 0.65, rtol=1e-14)


def test_polar_of_the_reference_wing():
    np.testing.assert_allclose(section_profile_drag(0.30, 1e7, **WING), 0.0068, rtol=1e-14)
    np.testing.assert_allclose(section_profile_drag(0.80, 1e7, **WING), 0.0068 + 0.006 * 0.25, rtol=1e-14)
    # friction at a tenth of the Reynolds number: 4.47 / 3.00 of the minimum, the curvature is the same
    np.testing.assert_allclose(section_profile_drag(0.30, 1e6, **WING), 0.0068 * 4.47 / 3.00, rtol=4e-3)
    drag = section_profile_drag(jnp.asarray([0.8, 0.3]), jnp.asarray([1e6, 1e6]), **WING)
    np.testing.assert_allclose(drag[0] - drag[1], 0.006 * 0.25, rtol=1e-12)


def test_derivatives(check_derivatives):
    check_derivatives(lambda x: section_profile_drag(x, 1e7 * x[::-1], **WING) * 100.0, [0.9, 0.5])
