"""The lattice against LAPACK and the field, on one wing, in one run.

    python benchmarks/bench_lattice.py --peers PYTHON --write docs/benchmarks.md

PYTHON is an interpreter with optvl, aerosandbox, pterasoftware and openaerostruct; without it ours and LAPACK
run alone. Every program runs in a process of its own with one thread for BLAS and XLA.
"""

import argparse
import json
import os
import subprocess
import sys
from datetime import date
from pathlib import Path

HERE = Path(__file__).parent
PEERS = {"optvl": 2000, "aerosandbox": 2000, "pterasoftware": 2000, "openaerostruct": 1000}  # unknowns that fit
BOUND = "solve, bound loads"
BOUND_LOADS = ("OptVL", "AeroSandbox", "OpenAeroStruct")  # as these have them
WHAT = ("solve", BOUND, "gradient", "derivatives", "gradient of derivatives")
ONE_THREAD = {
    **{f"{name}_NUM_THREADS": "1" for name in ("OMP", "OPENBLAS", "MKL", "NUMBA")},
    "XLA_FLAGS": "--xla_cpu_multi_thread_eigen=false",
    "OPENMDAO_REPORTS": "0",
}
# Freed arrays go back to the system while peaks are read; times are those of the allocator as it comes.
RETURN = {"MALLOC_MMAP_THRESHOLD_": "1000000"}
HEAD = """# Benchmarks of the lattice

Made by `python benchmarks/bench_lattice.py --peers PYTHON --write docs/benchmarks.md`.

A straight tapered wing, half model with as many panels as unknowns (AeroSandbox and PteraSoftware: both halves
with as many panels in all). CPU milliseconds of the process for one call, least of several means, one thread;
the first call, which compiles, is not counted. `gradient`: CL, CD, Cm by alpha and, with us, all nodes of the
mesh (OptVL: its sections); `derivatives`: all coefficients by alpha, beta, p, q, r, and with us three controls;
`gradient of derivatives`: CL_alpha, Cm_alpha, Cm_q by the same geometry. Both include the solve. `bound loads`:
forces on the bound filaments alone, as OptVL, AeroSandbox and OpenAeroStruct have them; ours take the chordwise
ones too. Memory is the peak during one call over that before it.
"""


def run(python, *command):
    """Results of one program, none if it fails or takes too long."""
    try:
        done = subprocess.run(
            [python, "-W", "ignore", *map(str, command)],
            env={**os.environ, **ONE_THREAD, **(RETURN if "memory" in command else {})},
            capture_output=True,
            text=True,
            timeout=600,
            check=True,
        )
    except (subprocess.CalledProcessError, subprocess.TimeoutExpired) as error:
        print(f"{command}: {error}\n{getattr(error, 'stderr', '')}", file=sys.stderr)
        return []
    return [json.loads(line) for line in done.stdout.splitlines() if line.startswith('{"program"')]


def collect(unknowns, peers):
    """All results on so many unknowns."""
    results = run(sys.executable, HERE / "lattice_case.py", unknowns)
    results += run(sys.executable, HERE / "lattice_case.py", unknowns, "memory")
    for peer in [name for name, most in PEERS.items() if peers and unknowns <= most]:
        results += run(peers, HERE / "peers" / f"{peer}_case.py", unknowns)
    return results


def table(unknowns, results):
    """Markdown of one number of unknowns."""
    seconds = {(r["program"], r["what"]): r["seconds"] for r in results if r["seconds"] is not None}
    memory = {(r["program"], r["what"].removesuffix(" memory")): r["memory"] for r in results if "memory" in r}
    lift = {r["program"]: r["CL"] for r in results if "CL" in r}
    lines = [f"\n## {unknowns} unknowns\n", "| | CL | " + " | ".join(f"{w}, ms" for w in WHAT) + " | solve, MB |"]
    lines.append("|---" * (len(WHAT) + 3) + "|")
    for program in dict.fromkeys(r["program"] for r in results):
        times = [seconds.get((program, w)) for w in WHAT]
        cells = ["" if t is None else f"{1e3 * t:.1f}" for t in times]
        size = memory.get((program, "solve"))
        cl = f"{lift[program]:.4f}" if program in lift else ""
        lines.append(f"| {program} | {cl} | " + " | ".join(cells) + f" | {'' if size is None else f'{size:.0f}'} |")
    return [*lines, "", *ratios(seconds), *(f"* memory of {w}: {memory['hera_om', w]:.0f} MB" for w in WHAT[1:])]


def ratios(seconds):
    """What the table says in ratios."""
    ours = {w: seconds["hera_om", w] for w in WHAT}
    lines = [f"* solve over LAPACK's factorisation: {ours['solve'] / seconds['LAPACK dgetrf', 'solve']:.2f}"]
    lines += [f"* {w} over solve: {ours[w] / ours['solve']:.2f}" for w in WHAT[1:]]
    for (program, what), value in seconds.items():
        if program not in ("hera_om", "LAPACK dgetrf"):
            lines.append(f"* {what}, {program} over ours: {value / ours[what]:.1f}")
            if what == "solve" and program in BOUND_LOADS:
                lines.append(f"* {BOUND}, {program} over ours: {value / ours[BOUND]:.1f}")
    return lines


def large(unknowns):
    """Time and memory of one solve too large for the others."""
    results = run(sys.executable, HERE / "lattice_case.py", unknowns, "memory")
    return [f"\n## {unknowns} unknowns\n", *(f"* {r['what']}: {r['memory']:.0f} MB" for r in results)]


def main():
    """Run, print, write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--peers", help="Python that has the peers")
    parser.add_argument("--write", type=Path, help="file for the table")
    parser.add_argument("--sizes", type=int, nargs="+", default=[1000, 2000])
    parser.add_argument("--large", type=int, help="unknowns of a solve for its memory, such as 8000")
    options = parser.parse_args()
    lines = [HEAD, f"Run on {date.today()}, {os.uname().machine}, Python {sys.version.split()[0]}."]
    for unknowns in options.sizes:
        lines += table(unknowns, collect(unknowns, options.peers))
    lines += large(options.large) if options.large else []
    text = "\n".join(lines) + "\n"
    print(text)
    if options.write:
        options.write.write_text(text)


if __name__ == "__main__":
    main()
