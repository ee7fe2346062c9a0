"""``python -m hera_om``: the command line."""

from hera_om.cli.app import run

if __name__ == "__main__":
    raise SystemExit(run())
