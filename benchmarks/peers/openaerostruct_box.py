"""OpenAeroStruct's wing box, one coupled flight point of the uCRM. Usage: openaerostruct_box.py STATIONS"""

import inspect
import itertools
import os
import sys
from pathlib import Path

os.environ.setdefault("OPENMDAO_REPORTS", "0")
import numpy as np
import openaerostruct.docs
import openmdao.api as om
from openaerostruct.integration.aerostruct_groups import AerostructGeometry, AerostructPoint
from openaerostruct.meshing.mesh_generator import generate_mesh

sys.path.insert(0, str(Path(__file__).parents[1]))
import measure

TWIST = np.array([4.0, 5.0, 8.0, 8.0, 8.0, 9.0])
STATE = {
    "Mach_number": (0.85, None),
    "v": (0.85 * 295.07, "m/s"),
    "re": (0.348 * 295.07 * 0.85 / 1.43e-5, "1/m"),
    "rho": (0.348, "kg/m**3"),
    "speed_of_sound": (295.07, "m/s"),
    "CT": (0.53 / 3600, "1/s"),
    "R": (14.307e6, "m"),
    "W0": (163000.0, "kg"),
    "load_factor": (1.0, None),
    "alpha": (0.0, "deg"),
    "empty_cg": (np.zeros(3), "m"),
}


def box_airfoil():
    """Coordinates of the box in the example that OpenAeroStruct ships."""
    source = Path(inspect.getfile(openaerostruct.docs)).parent / "wingbox_mpt_opt_example.py"
    text = source.read_text()
    names = {"np": np}
    exec(text[text.index("upper_x = ") : text.index("# fmt: on")], names)
    return {f"data_{axis}_{side}": names[f"{side}_{axis}"] for axis in "xy" for side in ("upper", "lower")}


def problem(stations):
    """The aerostructural point with the options of OpenAeroStruct's own wing-box example."""
    mesh, _ = generate_mesh(
        {"num_y": 2 * stations - 1, "num_x": 2, "wing_type": "uCRM_based", "symmetry": True, "num_twist_cp": 6}
    )
    surface = box_airfoil() | {
        **{"name": "wing", "symmetry": True, "S_ref_type": "wetted", "mesh": mesh, "fem_model_type": "wingbox"},
        **{"twist_cp": TWIST, "spar_thickness_cp": np.array([4, 5, 5, 8, 8, 10]) * 1e-3},
        **{"skin_thickness_cp": np.array([5, 10, 15, 20, 25, 26]) * 1e-3},
        **{"t_over_c_cp": np.array([0.08, 0.08, 0.08, 0.10, 0.10, 0.08]), "original_wingbox_airfoil_t_over_c": 0.12},
        **{"CL0": 0.0, "CD0": 0.0078, "with_viscous": True, "with_wave": True, "k_lam": 0.05, "c_max_t": 0.38},
        **{"E": 73.1e9, "G": 73.1e9 / 2.66, "yield": 420e6, "safety_factor": 1.5, "mrho": 2780.0},
        **{"strength_factor_for_upper_skin": 1.0, "wing_weight_ratio": 1.25, "struct_weight_relief": True},
        **{"distributed_fuel_weight": False, "exact_failure_constraint": False, "fuel_density": 803.0},
        "Wf_reserve": 15000.0,
    }
    found = om.Problem(reports=False)
    inputs = found.model.add_subsystem("inputs", om.IndepVarComp(), promotes=["*"])
    for name, (value, units) in STATE.items():
        inputs.add_output(name, val=value, units=units)
    found.model.add_subsystem("wing", AerostructGeometry(surface=surface))
    taken = [name for name in STATE if name != "R"] + ["R"]
    found.model.add_subsystem("point", AerostructPoint(surfaces=[surface]), promotes_inputs=taken)
    for name in ("local_stiff_transformed", "nodes", "mesh", "element_mass"):
        found.model.connect(f"wing.{name}", f"point.coupled.wing.{name}")
    found.model.connect("load_factor", "point.coupled.load_factor")
    for name in ("nodes", "Qz", "J", "A_enc", "htop", "hbottom", "hfront", "hrear", "spar_thickness", "t_over_c"):
        found.model.connect(f"wing.{name}", f"point.wing_perf.{name}")
    found.model.connect("wing.cg_location", "point.total_perf.wing_cg_location")
    found.model.connect("wing.structural_mass", "point.total_perf.wing_structural_mass")
    found.model.add_objective("point.fuelburn")
    for name in ("twist_cp", "spar_thickness_cp", "skin_thickness_cp", "geometry.t_over_c_cp"):
        found.model.add_design_var(f"wing.{name}")
    found.model.add_design_var("alpha")
    found.model.add_constraint("point.wing_perf.failure", upper=0.0)
    found.model.add_constraint("point.CL", equals=0.5)
    found.driver = om.ScipyOptimizeDriver()
    found.setup(mode="rev")
    return found


case = problem(int(sys.argv[1]))
shift = itertools.cycle((1.0, 1.001))


def run():
    case["wing.twist_cp"] = TWIST * next(shift)
    case.run_model()


run()
measure.emit("OpenAeroStruct", "run", measure.cpu_time(run, repeats=3))
measure.emit("OpenAeroStruct", "totals", measure.cpu_time(case.compute_totals, repeats=2))
