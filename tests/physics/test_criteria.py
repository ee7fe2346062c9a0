"""Criteria as data against the reference table; margins."""

import csv

import jax.numpy as jnp
import numpy as np
import pytest

from hera_om.physics.criteria import (
    ALL_CLASSES,
    CRITERIA,
    DEF_STAN,
    MIL,
    TABLE_7,
    doubling_time_margin,
    margin,
    select,
)

NAMES = {
    "CAP=wsp^2/(n/alpha)": "CAP", "wsp_min rad/s": "omega_sp", "wsp rad/s": "omega_sp",
    "n/alpha_min": "n_alpha", "zeta_phugoid": "zeta_ph", "T2_phugoid s": "t2_phugoid", "zeta_d": "zeta_dr",
    "zeta_d*w_d": "zeta_omega_dr", "w_d": "omega_dr", "T_roll s": "tau_roll", "T2_spiral s": "t2_spiral",
    "SM percent": "static_margin",
}  # fmt: skip
CLASSES = {"all": ALL_CLASSES, "II-L,III": ("II-L", "III"), "II,III": ("II", "III"), "III": ("III",)}
CATEGORIES = {"all": "ABC", "A C": "AC", "cruise": "B"}


def printed(reference, standard):
    """Rows of the reference table in the form of the data; percent as fractions."""
    lines = [line for line in (reference / "fq_criteria.csv").read_text().splitlines() if line[0] != "#"]
    for row in csv.DictReader(lines):
        if row["standard"].startswith(standard):
            unit = 0.01 if "percent" in row["quantity"] else 1.0
            limits = [round(float(row[side]) * unit, 6) if row[side] else None for side in ("min", "max")]
            yield (
                NAMES.get(row["quantity"], row["quantity"]), *limits,
                CATEGORIES.get(row["category"], row["category"]), CLASSES[row["class"]], int(row["level"]),
            )  # fmt: skip


def held(rows, standard):
    return [(c.quantity, c.lower, c.upper, c.categories, c.classes, c.level) for c in rows if c.standard == standard]


@pytest.mark.parametrize("standard", [MIL, DEF_STAN])
def test_every_printed_limit_is_held_and_no_other(reference, standard):
    expected = list(printed(reference, standard.split(" (")[0]))
    assert len(expected) >= 2
    assert sorted(held(CRITERIA, standard), key=repr) == sorted(expected, key=repr)


def test_table_7(reference):
    paper = [c for c in TABLE_7 if c.quantity not in ("RFC", "RFT")]
    assert held(paper, TABLE_7[0].standard) == list(printed(reference, "the paper Table 7"))
    assert {(c.quantity, c.lower, c.upper) for c in TABLE_7 if c not in paper} == {
        ("RFC", 1.5, None),
        ("RFT", 1.5, None),
    }


def test_select():
    assert select("zeta_sp", "B", "III").lower == 0.3
    assert select("zeta_sp", "C", "III", standard=DEF_STAN).lower == 0.5
    assert select("zeta_dr", "A", "II-L").lower == 0.19
    assert select("t2_spiral", "C", "I").lower == 12.0
    with pytest.raises(KeyError, match="level 3 limit on CAP, category B, class III"):
        select("CAP", "B", "III", level=3)


def test_margins_are_signed_and_normalised():
    both = margin(2.0, 2.3, 3.5)
    np.testing.assert_allclose([both.lower, both.upper], [-0.25, 1.25])
    assert margin(0.05, 0.04, None).upper is None
    np.testing.assert_allclose(margin(0.05, 0.04, None).lower, 0.25)
    np.testing.assert_allclose(margin(1.0, None, 1.4).upper, 0.4 / 1.4)
    np.testing.assert_allclose(margin(-0.1, 0.0, None).lower, -0.1)


@pytest.mark.parametrize(("limits", "message"), [((None, None), "both are None"), ((3.5, 2.3), "not below")])
def test_margins_without_sense_are_refused(limits, message):
    with pytest.raises(ValueError, match=message):
        margin(1.0, *limits)


def test_doubling_time_margin_counts_a_stable_spiral_as_met():
    assert float(doubling_time_margin(-0.0073, 20.0)) > 1.0
    np.testing.assert_allclose(doubling_time_margin(np.log(2.0) / 20.0, 20.0), 0.0, atol=1e-15)
    assert float(doubling_time_margin(np.log(2.0) / 12.0, 20.0)) < 0.0


def test_derivatives(check_derivatives):
    check_derivatives(
        lambda x: jnp.stack([*margin(x[0], 2.3, 3.5), doubling_time_margin(0.02 * x[1], 20.0)]), [2.0, 1.0]
    )
