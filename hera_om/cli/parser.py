"""What the command line accepts. Only the standard library is imported: ``--help`` must be immediate."""

import argparse
from collections.abc import Callable
from typing import Any, NoReturn

from hera_om.core.errors import InputError, Problem

COMMAND_LINE = "command line"  # stands for the file in a problem of an option

_EPILOG = """\
AIRCRAFT is the name of a shipped definition (hera_like) or the path of a TOML file.
Exit status: 0 done; 2 bad input; 3 analysis failed or result infeasible; 1 internal error; 130 interrupted.
'hera-om COMMAND --help' has the options of a command."""

_SET_HELP = (
    "change one number; repeatable, the last one counts. A bare NAME is an input (alpha, mach, theta_hybrid) "
    "in its registry unit or a design variable of the definition; a dotted NAME is a number of the "
    "definition (wing.section.tip.twist_deg)"
)


class Parser(argparse.ArgumentParser):
    """A parser whose errors are reported as every other bad input is."""

    def __init__(self, **options: Any) -> None:
        options.setdefault("allow_abbrev", False)
        super().__init__(**options)

    def error(self, message: str) -> NoReturn:
        """Raise instead of printing a usage and leaving."""
        raise InputError([Problem(COMMAND_LINE, "", message, f"what '{self.prog} --help' lists")])


class _Version(argparse.Action):
    """Look the version up only when it is asked for."""

    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> NoReturn:
        from hera_om.core.provenance import provenance

        print("hera-om", provenance()["hera_om"] or "(not installed)")
        parser.exit()


def build_parser() -> Parser:
    """The parser of ``hera-om``, with one subparser for each command."""
    parser = Parser(
        prog="hera-om",
        description="Optimisation of distributed-electric-propulsion aircraft.",
        epilog=_EPILOG,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.add_argument("--version", action=_Version, nargs=0, help="print the version and leave")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", title="commands", required=True)
    for name, (summary, add) in _COMMANDS.items():
        command = commands.add_parser(name, help=summary, description=f"{summary[0].upper()}{summary[1:]}.")
        add(command)
        _add_common(command)
    return parser


def _add_common(parser: argparse.ArgumentParser) -> None:
    """Options that every command has."""
    parser.add_argument("--json", action="store_true", help="print one JSON object on standard output and nothing else")
    parser.add_argument("--debug", action="store_true", help="print the traceback of a failure")


def _add_aircraft(parser: argparse.ArgumentParser) -> None:
    """The definition and what changes it."""
    parser.add_argument("aircraft", metavar="AIRCRAFT", help="shipped name, or path of a TOML file")
    parser.add_argument("--set", dest="assignments", metavar="NAME=VALUE", action="append", default=[], help=_SET_HELP)


def _add_aero(parser: argparse.ArgumentParser) -> None:
    """Where the aerodynamics comes from."""
    parser.add_argument(
        "--aero",
        metavar="SOURCE",
        default="lattice",
        help="lattice (default), surrogate, or the file of a surrogate",
    )
    parser.add_argument(
        "--surrogate",
        metavar="FILE",
        help="with --aero surrogate: its file (default: NAME_surrogate.npz in the current folder)",
    )


def _add_trim(parser: argparse.ArgumentParser) -> None:
    """Options of ``trim``."""
    _add_aircraft(parser)
    parser.add_argument(
        "--method",
        choices=("solve", "SLSQP"),
        default="solve",
        help="solve: balance with the split of thrust held (default); SLSQP: best L/D, the split falls out",
    )
    parser.add_argument("--load-factor", metavar="N", default="1", help="load factor (default 1)")
    parser.add_argument("--db", metavar="FILE", help="record the run in this database")
    _add_aero(parser)


def _add_mdo(parser: argparse.ArgumentParser) -> None:
    """Options of ``mdo``."""
    _add_aircraft(parser)
    parser.add_argument("--driver", choices=("SLSQP", "COBYLA"), default="SLSQP", help="optimiser (default SLSQP)")
    parser.add_argument(
        "--start",
        choices=("baseline", "low", "high"),
        default="baseline",
        help="where the variables start: the definition, near the lower or near the upper bounds",
    )
    parser.add_argument("--max-iterations", metavar="N", help="stop after N iterations")
    parser.add_argument("--db", metavar="FILE", default="mdo.db", help="database of the run (default mdo.db)")
    _add_aero(parser)


def _add_train(parser: argparse.ArgumentParser) -> None:
    """Options of ``train``."""
    _add_aircraft(parser)
    parser.add_argument("--samples", metavar="N", default="200", help="training samples (default 200)")
    parser.add_argument("--seed", metavar="N", default="0", help="seed of the sampling plan (default 0)")
    parser.add_argument(
        "--out",
        metavar="FILE",
        help="file of the surrogate, ending in .npz (default NAME_surrogate.npz in the current folder)",
    )


def _add_interaction(parser: argparse.ArgumentParser) -> None:
    """Options of ``interaction``."""
    _add_aircraft(parser)
    parser.add_argument("--out", dest="folder", metavar="FOLDER", help="draw the figures as PNG into this folder")


def _add_report(parser: argparse.ArgumentParser) -> None:
    """Options of ``report``."""
    parser.add_argument("database", metavar="DB", help="database of a run")
    parser.add_argument("--out", metavar="FILE", help="page to write (default: DB with the ending .html)")


_COMMANDS: dict[str, tuple[str, Callable[[argparse.ArgumentParser], None]]] = {
    "check": ("read a definition and name everything that is wrong in it", _add_aircraft),
    "analyze": ("forces, moments and their derivatives at one flight condition", _add_aircraft),
    "trim": ("angle of attack, elevator and blade pitches for steady flight", _add_trim),
    "mdo": ("optimise the design variables of the definition", _add_mdo),
    "train": ("train surrogates of the aerodynamics and judge them on unseen points", _add_train),
    "interaction": ("what rotors, wing and tail do to each other, beside the paper's Tables 2 and 3", _add_interaction),
    "report": ("turn the database of a run into a page of tables and pictures", _add_report),
}
