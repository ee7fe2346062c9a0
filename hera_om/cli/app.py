"""The entry point: run a command, show what it found, end with the promised status."""

import argparse
import gc
import os
import sys
import traceback
from collections.abc import Sequence

from hera_om.cli.output import (
    BAD_INPUT,
    DONE,
    INTERNAL,
    Failure,
    dump,
    emit,
    failure_of,
    interruption,
    say,
    stdout_to_stderr,
)
from hera_om.cli.parser import build_parser
from hera_om.core.programs import busy, keep

GARBAGE_EVERY = 1_000_000  # new objects


def run() -> int:
    """`main` as a process of its own, which need not look for garbage.

    Tracing makes millions of small objects that all stay: looking for garbage among them takes a third of
    the time of a short command, and at the end once more. Its pictures go to files: asked for a backend,
    Matplotlib would look for a display, and OpenMDAO asks when it is imported.
    """
    os.environ.setdefault("MPLBACKEND", "agg")
    gc.set_threshold(GARBAGE_EVERY)
    keep()
    status = main()
    gc.freeze()
    if busy():  # a thread inside XLA does not survive the end of the interpreter
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(status)
    return status


def main(argv: Sequence[str] | None = None) -> int:
    """Run ``hera-om`` with these arguments, by default those of the process.

    Returns:
        The exit status: 0 done, 2 bad input, 3 analysis failed or result infeasible, 1 internal error,
        130 interrupted.
    """
    words = list(sys.argv[1:] if argv is None else argv)
    try:
        return _run(words)
    except OSError as error:
        say(f"hera-om: standard output: {error.strerror or error}")
        return INTERNAL


def _run(words: list[str]) -> int:
    """Parse, run, show; whatever is raised on the way becomes a failure."""
    as_json = "--json" in words  # known before the arguments are, whose own faults are reported the same way
    args: argparse.Namespace | None = None
    text = ""
    try:
        parser = build_parser()
        if not words:
            say(parser.format_help().rstrip())
            return BAD_INPUT
        args = parser.parse_args(words)
        text, failure = _command(args)
    except SystemExit as leaving:  # --help and --version have printed
        emit("", end="")
        return int(leaving.code or DONE)
    except KeyboardInterrupt:
        failure = interruption(getattr(args, "db", None))
    except Exception as error:
        if "--debug" in words:
            say(traceback.format_exc().rstrip())
        failure = failure_of(error, getattr(args, "command", None))
    if as_json and failure and not text:
        text = dump({"error": failure.to_json()})
    if text:
        emit(text)
    if failure:
        say(failure.message)
    return failure.status if failure else DONE


def _command(args: argparse.Namespace) -> tuple[str, Failure | None]:
    """What a command has to print, and why it is not good enough, if so."""
    with stdout_to_stderr():
        from hera_om.cli.commands import COMMANDS

        result, show, failure = COMMANDS[args.command](args)
        if not args.json:
            return show(result), failure
        return dump({**result, "error": failure.to_json()} if failure else result), failure
