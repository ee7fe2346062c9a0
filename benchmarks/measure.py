"""Timer, memory and output of the benchmarks; numpy-free, shared with the peers' drivers."""

import gc
import json
import time

REPEATS, SPAN = 5, 0.3  # measurements, and the seconds that one should take at least


def cpu_time(function, repeats=REPEATS, span=SPAN):
    """CPU seconds of the process for one call: the least of several means. The clock ticks coarsely, so a
    measurement holds as many calls as fill ``span``; one slow call is measured once.
    """
    function()
    start = time.process_time()
    function()
    once = time.process_time() - start
    if once > 5:
        return once
    calls, best = max(1, int(span / max(once, 1e-4))), once if once > span else float("inf")
    for _ in range(repeats):
        start = time.process_time()
        for _ in range(calls):
            function()
        best = min(best, (time.process_time() - start) / calls)
    return best


def _status(key):
    with open("/proc/self/status") as file:
        return next(int(line.split()[1]) / 1024 for line in file if line.startswith(key))


def extra_memory(function):
    """Peak of the resident memory during one call over that before it, MB (Linux)."""
    gc.collect()
    with open("/proc/self/clear_refs", "w") as file:
        file.write("5")
    before = _status("VmRSS")
    function()
    return _status("VmHWM") - before


def emit(program, what, seconds=None, **more):
    """One result as a line of JSON."""
    print(json.dumps({"program": program, "what": what, "seconds": seconds, **more}), flush=True)
