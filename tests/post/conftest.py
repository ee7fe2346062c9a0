"""A synthetic run, written through `Record` with numbers that are plausible for the shipped aircraft."""

from types import SimpleNamespace

import numpy as np
import pytest

from hera_om.aircraft import load_aircraft
from hera_om.studies.record import Record

CONSTRAINTS = [
    {"name": "static_margin", "units": None, "lower": 0.05, "upper": 0.35, "reason": "Table 7"},
    {"name": "omega_sp", "units": "rad/s", "lower": 2.3, "upper": 3.5, "reason": "Table 7"},
    {"name": "zeta_sp", "units": None, "lower": 0.2, "upper": 1.4, "reason": "Table 7"},
    {"name": "zeta_ph", "units": None, "lower": 0.04, "upper": None, "reason": "Table 7"},
    {"name": "RFC", "units": None, "lower": 1.5, "upper": None, "reason": "CS 25.303"},
    {"name": "RFT", "units": None, "lower": 1.5, "upper": None, "reason": "CS 25.303"},
]
OBJECTIVE = {"name": "range_fixed_mass", "units": "km", "sense": "max"}
START = {
    "y_kink": 5.6, "theta_tip": -3.0, "y_prop": 8.0, "htail_scale": 1.0, "A_cap_root": 3e-3,
    "A_stringer_root": 3.5e-4,
}  # fmt: skip
END = {
    "y_kink": 4.1, "theta_tip": -1.2, "y_prop": 10.0, "htail_scale": 1.08, "A_cap_root": 2.2e-3,
    "A_stringer_root": 6e-4,
}  # fmt: skip
BEFORE = {
    "CL": 0.4851, "CD": 0.03042, "CDi": 0.00655, "CDi_near": 0.00668, "CD_slipstream": -0.00051,
    "CD_profile": 0.0108,
    "CD_fuselage": 0.00502, "CD_areas": 0.00843, "L_over_D": 15.95, "alpha": 0.93, "delta_e": -1.2,
    "power": 3.65e6,
    "static_margin": 0.215, "omega_sp": 2.12, "zeta_sp": 0.61, "zeta_ph": 0.0443, "CAP": 0.41, "RFC": 1.86,
    "RFT": 1.71,
    "m_wing": 3300.0, "mass": 28153.0, "range_fixed_mass": 1218.0, "m_skins": 1310.0, "m_webs": 214.0,
    "m_caps": 402.0, "m_stringers": 371.0, "m_ribs": 130.0, "m_remainder": 444.6,
}  # fmt: skip
AFTER = BEFORE | {
    "CD": 0.02940, "CDi": 0.00600, "CDi_near": 0.00612, "CD_slipstream": -0.00073, "CD_profile": 0.01064,
    "CD_areas": 0.00835, "L_over_D": 16.31, "alpha": 0.71, "delta_e": -0.8, "power": 3.52e6,
    "static_margin": 0.287,
    "omega_sp": 2.30, "zeta_sp": 0.68, "zeta_ph": 0.0434, "CAP": 0.47, "RFC": 1.5, "RFT": 1.52,
    "m_wing": 2921.0,
    "range_fixed_mass": 1396.0, "m_skins": 1010.0, "m_webs": 205.0, "m_caps": 295.0, "m_stringers": 480.0,
    "m_ribs": 120.0,
}  # fmt: skip
UNITS = {"power": "W", "alpha": "deg", "delta_e": "deg", "omega_sp": "rad/s", "m_wing": "kg", "mass": "kg"}


def arrays(design, off=0.9):
    """Arrays of a snapshot."""
    y = np.linspace(0.2, 14.4, 40)
    k, p, t = design["y_kink"], design["y_prop"], design["theta_tip"]
    chord = np.interp(y, [0.0, k, 14.5], [2.77, 2.77, 1.61])
    clean = 0.55 * np.sqrt(1 - (y / 14.55) ** 2) * 2.6 / chord * (1 + 0.02 * t * (y / 14.5 - 0.5))
    wash = sum(0.07 * np.sin(np.pi * np.clip((y - h) / r, -1, 1)) for h, r in ((4.1, 1.95), (p, 1.2), (p + 2.75, 1.2)))
    s = design["htail_scale"]
    b, c = 3.54 * s, 1.925 * s
    eta = np.linspace(0.02, 0.98, 24)
    mass = {m.name: m.m_kg for m in load_aircraft("hera_like").mass}
    if design == END:  # the mass saved becomes fuel
        mass |= {"wing": 2921.0, "htail": 170.0 * s**2, "fuel": 3679.0 - 170.0 * (s**2 - 1.0)}
    return {
        "y_span": y,
        "chord_span": chord,
        "cl_span": clean + 0.03 + wash,
        "cl_span_off": clean * off,
        "wing_outline": [[11.0, 0.0], [11.0, k], [11.65, 14.5], [13.26, 14.5], [13.77, k], [13.77, 0.0]],
        "htail_outline": [[25.0 - 0.3 * c, 0.0], [25.3, b], [25.3 + 0.6 * c, b], [25.0 + 0.9 * c, 0.0]],
        "rotors": [[9.4, 4.1, 0.9, 1.95], [9.97, p, 1.3, 1.2], [10.05, p + 2.75, 1.4, 1.2]],
        "box": {
            "eta": eta,
            "y": 14.5 * eta,
            "t_skin_upper": 0.0012 + 0.0035 * (1 - eta) ** 1.4 * design["A_cap_root"] / 3e-3,
            "t_skin_lower": 0.0012 + 0.0028 * (1 - eta) ** 1.4,
            "t_web_front": 0.0012 + 0.0018 * (1 - eta),
            "t_web_rear": 0.0012 + 0.0012 * (1 - eta),
            "RFC_span": (1.5 + 0.12 * (design["A_cap_root"] > 2.5e-3)) * (1 + 4 * eta**4 + 0.3 * np.sin(3 * eta) ** 2),
            "RFT_span": 1.52 * (1 + 5 * eta**4 + 0.2 * np.sin(4 * eta) ** 2),
        },
        "mass_items": mass,
    }


def between(share):
    """Design and outputs part of the way."""
    design = {k: START[k] + share * (END[k] - START[k]) for k in START}
    outputs = {k: BEFORE[k] + share * (AFTER[k] - BEFORE[k]) for k in BEFORE}
    return design, outputs


def row(i, share, wiggle=0.0):
    """A row of history."""
    design, outputs = between(share)
    outputs["omega_sp"] += 0.5 * wiggle
    values = {c["name"]: outputs[c["name"]] for c in CONSTRAINTS}
    violation = max(0.0, (2.3 - values["omega_sp"]) / 3.5, (1.5 - values["RFC"] + wiggle) / 1.5)
    return {
        "iteration": i, "time_s": 2.0 + 1.5 * i, "objective": outputs["range_fixed_mass"] + 300 * wiggle,
        "worst_violation": violation, "variables": design, "constraints": values, "outputs": outputs,
    }  # fmt: skip


def result():
    """The result of the synthetic run."""
    multipliers = {"omega_sp": 61.2, "RFC": 140.5}
    told = {}
    for c in CONSTRAINTS:
        value = AFTER[c["name"]]
        low, high = c["lower"], c["upper"]
        margin = min(value - low, (high - value) if high is not None else np.inf)
        active = c["name"] in multipliers
        told[c["name"]] = {
            "value": value, "lower": low, "upper": high, "margin": margin,
            "multiplier": multipliers.get(c["name"], 0.0), "active": active, "violated": False,
        }  # fmt: skip
    return {
        "baseline": BEFORE | START, "optimum": AFTER | END, "constraints": told,
        "success": True, "feasible": True,
        "message": "Optimization terminated successfully", "iterations": 9, "evaluations": 12, "gradients": 9,
        "seconds": 58.3,
        "gain": {
            "induced": 24.0, "profile": 7.5, "fixed_area": 3.6, "slipstream": 9.9, "shaft_power": -4.0,
            "structural_mass": 137.0, "fuel": 0.0, "total": 178.0,
        },
    }  # fmt: skip


def write(path, *, until="result"):
    """Write the run up to a stage: ``head``, ``history``, ``optimum`` or ``result``."""
    aircraft = load_aircraft("hera_like")
    options = {"driver": "SLSQP", "aero": "lattice", "tol": 1e-6, "start": "baseline"}
    with Record(
        path, kind="mdo", aircraft=aircraft, options=options, constraints=CONSTRAINTS, objective=OBJECTIVE
    ) as r:
        if until != "head":
            values = {"values": BEFORE | START, "units": UNITS, "arrays": arrays(START)}
            r.snapshot("baseline", values)
            wiggles = [0, 0.25, -0.3, 0.12, 0.05, -0.04, 0.02, 0.01, 0, 0, 0, 0]
            shares = [0, 0.9, 0.35, 0.55, 0.7, 0.78, 0.86, 0.92, 0.96, 0.99, 1.0, 1.0]
            for i, (share, wiggle) in enumerate(zip(shares, wiggles, strict=True), start=1):
                r.history(row(i, share, wiggle))
        if until in ("optimum", "result"):
            r.snapshot("optimum", {"values": AFTER | END, "units": UNITS, "arrays": arrays(END)})
        if until == "result":
            r.result(result())
    return path


@pytest.fixture(scope="session")
def synthetic():
    """The numbers of the synthetic run, and what writes it."""
    return SimpleNamespace(
        before=BEFORE, after=AFTER, start=START, end=END, constraints=CONSTRAINTS, objective=OBJECTIVE,
        arrays=arrays, row=row, result=result, write=write,
    )  # fmt: skip


@pytest.fixture(scope="session")
def database(tmp_path_factory):
    """A finished run; not to be changed by a test."""
    return write(tmp_path_factory.mktemp("run") / "mdo.db")
