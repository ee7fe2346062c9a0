"""Runs behind docs/results.md: starts, drivers, and runs that isolate the causes of the optimum's directions."""

import argparse
from pathlib import Path

import numpy as np

from hera_om.aircraft import Aircraft, load_aircraft, variable_box
from hera_om.models.problems import build_aircraft
from hera_om.studies import mdo

RUNS = {
    "SLSQP from the baseline": {},
    "SLSQP from the low quarter": {"start": "low"},
    "SLSQP from the high quarter": {"start": "high"},
    "COBYLA from the baseline": {"driver": "COBYLA"},
    "SLSQP, range at fixed fuel": {"objective": "range_fixed_fuel"},
}
STATE = "range_fixed_mass range_fixed_fuel L_over_D m_wing power static_margin omega_sp RFC RFT".split()
CAP_AREAS = np.linspace(1.0e-3, 5.0e-3, 9)


def runs(aircraft: Aircraft, folder: Path) -> list[str]:
    """One row a run: counts, objective, variables, state."""
    names = variable_box(aircraft).names
    lines = ["| run | feasible | evaluations | gradients | s | " + " | ".join((*names, *STATE)) + " |"]
    lines.append("|" + "---|" * (5 + len(names) + len(STATE)))
    for label, options in RUNS.items():
        r = mdo(aircraft, database=folder / f"{label.replace(' ', '_').replace(',', '')}.db", **options)
        if len(lines) == 2:
            cells = [f"{r['baseline'][n]:.5g}" for n in (*names, *STATE)]
            lines.append("| baseline | | | | | " + " | ".join(cells) + " |")
        cells = [f"{r['optimum'][n]:.5g}" for n in (*names, *STATE)]
        head = f"| {label} | {r['feasible']} | {r['evaluations']} | {r['gradients']} | {r['seconds']:.0f} | "
        lines.append(head + " | ".join(cells) + " |")
        print(lines[-1], flush=True)
    return lines


def sensitivities(aircraft: Aircraft) -> list[str]:
    """Exact derivatives at the baseline, by a tenth of each variable's range."""
    problem, box = build_aircraft(aircraft), variable_box(aircraft)
    problem.run_model()
    totals = problem.compute_totals(list(STATE), list(box.names))
    lines = ["| a tenth of the range of | " + " | ".join(STATE) + " |", "|" + "---|" * (1 + len(STATE))]
    for n, low, high in zip(box.names, box.lower, box.upper, strict=True):
        step = 0.1 * (high - low)
        lines.append(f"| {n} | " + " | ".join(f"{totals[s, n][0, 0] * step:+.4g}" for s in STATE) + " |")
    return lines


def reserve_factors(aircraft: Aircraft) -> list[str]:
    """RFC and RFT over the cap's area."""
    problem = build_aircraft(aircraft)
    lines = ["| A_cap_root [m2] | RFC | RFT | m_wing [kg] |", "|---|---|---|---|"]
    for area in CAP_AREAS:
        problem.set_val("A_cap_root", area, units="m**2")
        problem.run_model()
        row = [float(problem.get_val(n)[0]) for n in ("RFC", "RFT", "m_wing")]
        lines.append(f"| {area:.4g} | {row[0]:.3f} | {row[1]:.3f} | {row[2]:.0f} |")
    return lines


def main() -> None:
    """Write the tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--runs", type=Path, default=Path("runs"), help="folder of the records")
    parser.add_argument("--out", type=Path, default=Path("docs/results_tables.md"))
    args = parser.parse_args()
    args.runs.mkdir(exist_ok=True)
    aircraft = load_aircraft("hera_like")
    parts = [
        ("Sensitivities of the baseline", sensitivities(aircraft)),
        ("Reserve factors over the cap's area, all else at the baseline", reserve_factors(aircraft)),
        ("Runs", runs(aircraft, args.runs)),
    ]
    text = "\n\n".join(f"## {title}\n\n" + "\n".join(lines) for title, lines in parts)
    args.out.write_text(f"# Tables made by docs/make_results.py\n\n{text}\n", encoding="utf-8")
    print(text)


if __name__ == "__main__":
    main()
