"""Wall seconds of ``hera-om analyze hera_like --json`` as a user starts it: with an empty cache, then with its own.

    python benchmarks/bench_start.py

Run it on an idle machine. The aims: 20 s with an empty cache, 3 s with a filled one.
"""

import os
import statistics
import subprocess
import sys
import tempfile
import time

from measure import emit

COMMAND = [sys.executable, "-m", "hera_om", "analyze", "hera_like", "--json"]
WARM = 5


def seconds(folder: str) -> float:
    """Wall seconds of the command with this cache folder."""
    start = time.perf_counter()
    subprocess.run(COMMAND, env=os.environ | {"HERA_OM_CACHE": folder}, stdout=subprocess.DEVNULL, check=True)
    return time.perf_counter() - start


with tempfile.TemporaryDirectory() as cache:
    emit("hera_om", "analyze, empty cache", seconds(cache))
    warm = [seconds(cache) for _ in range(WARM)]
emit("hera_om", f"analyze, filled cache, median of {WARM}", statistics.median(warm), least=min(warm), most=max(warm))
