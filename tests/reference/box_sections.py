"""Makes box_sections.csv: thin-walled boxes as solids in sectionproperties, finite elements of St Venant's problem.

    python tests/reference/box_sections.py      (needs sectionproperties, in the extra "sections"; a minute)

Walls stand astride the contour, webs are upright; nothing here is shared with hera_om.
"""

from importlib.metadata import version
from pathlib import Path

import numpy as np
from sectionproperties.analysis import Section
from sectionproperties.pre import Geometry
from shapely import LineString, box, unary_union

# name: NACA digits or rectangle, chord, t/c, spars, sheets (upper, lower, front, rear), caps and stringers
CASES = {
    "rectangle": (None, 1.2, 0.4, 0.0, 1.0, (0.003, 0.003, 0.004, 0.006), None),
    "root_43018": ("43018", 2.77, 0.18, 0.15, 0.62, (0.005, 0.0022, 0.0068, 0.0053), None),
    "tip_43013": ("43013", 1.61, 0.13, 0.15, 0.62, (0.0016, 0.0014, 0.002, 0.0017), None),
    "naca_2412": ("2412", 2.0, 0.12, 0.10, 0.70, (0.003, 0.003, 0.003, 0.003), None),
    "naca_4418": ("4418", 3.0, 0.18, 0.20, 0.65, (0.004, 0.006, 0.003, 0.010), None),
    "members": ("43018", 2.77, 0.18, 0.15, 0.62, (0.0015, 0.001, 0.002, 0.0016), (1.5e-3, 3.5e-4, 8)),
}
FIVE = {"30": (0.2025, 15.957)}


def camber(digits, x):
    """Abbott & von Doenhoff eqs. 6.4 and 6.6."""
    if len(digits) == 4:
        m, p = int(digits[0]) / 100, int(digits[1]) / 10
        ahead = m / p**2 * (2 * p * x - x**2)
        return np.where(x < p, ahead, m / (1 - p) ** 2 * (1 - 2 * p + 2 * p * x - x**2))
    m, k = FIVE[digits[1:3]]
    k *= int(digits[0]) * 0.15 / 0.3
    return np.where(x < m, k / 6 * (x**3 - 3 * m * x**2 + m**2 * (3 - m) * x), k / 6 * m**3 * (1 - x))


def covers(digits, chord, ratio, front, rear):
    """Points of upper and lower cover."""
    x = np.linspace(front, rear, 161)
    if digits is None:
        z = np.full_like(x, ratio / 2)
        return np.stack([chord * x, z], 1), np.stack([chord * x, -z], 1)
    half = 5 * ratio * (0.2969 * np.sqrt(x) - 0.126 * x - 0.3516 * x**2 + 0.2843 * x**3 - 0.1015 * x**4)
    mean = camber(digits, x)
    return np.stack([x, mean + half], 1) * chord, np.stack([x, mean - half], 1) * chord


def members(upper, lower, t, cap, stringer, count):
    """Flanges four times as wide as thick beside the webs, blades as high as a Z stringer, all under the skin."""
    parts = []
    for line, inward, skin in ((upper, -1.0, t[0]), (lower, 1.0, t[1])):
        line = line + np.array([0.0, inward * skin / 2])
        for (x, z), web in zip((line[0], line[-1]), t[2:], strict=True):
            thick = np.sqrt(cap / 4)
            ends = sorted((z, z + inward * thick))
            parts += [box(x + web / 2, ends[0], x + web / 2 + 2 * thick, ends[1])]
            parts += [box(x - web / 2 - 2 * thick, ends[0], x - web / 2, ends[1])]
        height = np.sqrt(stringer * 16 / 1.8)
        arc = np.concatenate([[0], np.cumsum(np.hypot(*np.diff(line, axis=0).T))])
        for k in range(count):
            x, z = (np.interp((k + 0.5) / count * arc[-1], arc, line[:, i]) for i in (0, 1))
            ends = sorted((z + 2e-4 * -inward, z + inward * height))
            parts.append(box(x - stringer / height / 2, ends[0], x + stringer / height / 2, ends[1]))
    return parts


def solve(digits, chord, ratio, front, rear, t, extra):
    """Properties of one box."""
    upper, lower = covers(digits, chord, ratio, front, rear)
    webs = [(np.stack([lower[i], upper[i]]), thick) for i, thick in ((0, t[2]), (-1, t[3]))]
    walls = [(upper, t[0]), (lower, t[1]), *webs]
    parts = [LineString(line).buffer(thick / 2, cap_style="flat") for line, thick in walls]
    corners = [p for line in (upper, lower) for p in (line[0], line[-1])]
    parts += [box(x - 1e-3, z - 1e-3, x + 1e-3, z + 1e-3) for x, z in corners]  # walls stay joined
    parts += members(upper, lower, t, *extra) if extra else []
    geometry = Geometry(unary_union(parts).simplify(1e-5))
    section = Section(geometry.create_mesh(mesh_sizes=[min(t) ** 2 * 2]))
    section.calculate_geometric_properties()
    section.calculate_warping_properties()
    x_c, z_c = section.get_c()
    ixx, izz, ixz = section.get_ic()
    x_s, z_s = section.get_sc()
    out = dict(area=section.get_area(), x_c=x_c, z_c=z_c, I_xx=ixx, I_zz=izz, I_xz=ixz)
    out |= dict(J=section.get_j(), x_sc=x_s, z_sc=z_s)
    stress = section.calculate_stress(vy=1.0)
    for name, (line, thick) in zip(("front", "rear"), webs, strict=True):
        middle = line.mean(axis=0)
        near = np.argsort(np.hypot(*(section.mesh["vertices"] - middle).T))[:6]
        out[f"q_{name}"] = np.mean(stress.get_stress()[0]["sig_zy_vy"][near]) * thick
    return out


def main():
    """Write the file beside this one."""
    rows = {name: solve(*case) for name, case in CASES.items()}
    head = [
        f"# source: sectionproperties {version('sectionproperties')} (finite elements), box_sections.py beside it",
        "# geometry: CASES there; section axes x aft of the leading edge, z up; m; q: flow at mid web per N up",
        "# confidence: 0.1 %; the solid has walls of finite thickness, which thin-wall theory has not",
        "name," + ",".join(next(iter(rows.values()))),
    ]
    lines = [f"{name}," + ",".join(f"{v:.6g}" for v in row.values()) for name, row in rows.items()]
    Path(__file__).with_suffix(".csv").write_text("\n".join(head + lines) + "\n")


if __name__ == "__main__":
    main()
