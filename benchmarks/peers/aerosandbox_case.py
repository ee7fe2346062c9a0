"""AeroSandbox, full model with as many unknowns (it has no half model). Usage: aerosandbox_case.py UNKNOWNS"""

import sys
from pathlib import Path

import aerosandbox as asb
import aerosandbox.numpy as anp

sys.path.insert(0, str(Path(__file__).parents[1]))
import measure
import wing

nc, ns = wing.PANELS[int(sys.argv[1])]
ns //= 2
segments = 10 if ns % 10 == 0 else 5
stations = zip(*wing.sections(segments + 1), strict=True)
airfoil = asb.Airfoil("naca0012")
cuts = [asb.WingXSec(xyz_le=[x, y, 0], chord=c, airfoil=airfoil) for y, x, c in stations]
airplane = asb.Airplane(
    wings=[asb.Wing(name="wing", symmetric=True, xsecs=cuts)],
    xyz_ref=[wing.X_REF, 0, 0],
    s_ref=wing.AREA,
    c_ref=wing.CHORD,
    b_ref=wing.SPAN,
)


def model():
    return asb.VortexLatticeMethod(
        airplane,
        asb.OperatingPoint(velocity=wing.SPEED, alpha=wing.ALPHA),
        spanwise_resolution=ns // segments,
        chordwise_resolution=nc,
        spanwise_spacing_function=anp.linspace,
        chordwise_spacing_function=anp.linspace,
    )


measure.emit("AeroSandbox", "solve memory", memory=measure.extra_memory(lambda: model().run()))
measure.emit("AeroSandbox", "solve", measure.cpu_time(lambda: model().run()), CL=float(model().run()["CL"]))
seconds = measure.cpu_time(lambda: model().run_with_stability_derivatives(), repeats=1)
measure.emit("AeroSandbox", "derivatives", seconds)
