"""The wing of the benchmarks, the same for every program: straight taper, flat, uniform panels, half model.

Needs numpy alone, so that the peers' drivers can import it from their own environment.
"""

import numpy as np

SPAN, ROOT, TIP, TIP_X = 27.05, 2.6, 1.6, 0.6  # m
AREA = SPAN * (ROOT + TIP) / 2
TAPER = TIP / ROOT
CHORD = 2 / 3 * ROOT * (1 + TAPER + TAPER**2) / (1 + TAPER)  # mean aerodynamic chord, m
X_REF = 1.0  # m
ALPHA, SPEED, DENSITY = 5.0, 100.0, 1.0  # degrees, m/s, kg/m^3
STATIONS = 11  # sections of the programs that take sections: 11 twists
PANELS = {240: (8, 30), 480: (12, 40), 1000: (20, 50), 2000: (25, 80), 8000: (50, 160)}  # chordwise, spanwise


def sections(count):
    """Spanwise position, leading edge and chord of ``count`` stations, m."""
    eta = np.linspace(0, 1, count)
    return eta * SPAN / 2, TIP_X * eta, ROOT + (TIP - ROOT) * eta


def mesh(unknowns):
    """Corner points of the panels of the starboard half [nc + 1, ns + 1, 3]."""
    nc, ns = PANELS[unknowns]
    y, x, chord = sections(ns + 1)
    out = np.zeros((nc + 1, ns + 1, 3))
    out[..., 0] = x + np.linspace(0, 1, nc + 1)[:, None] * chord
    out[..., 1] = y
    return out
