"""The command line over studies and post. Nothing heavy is imported before a command runs."""

from hera_om.cli.app import main as main
from hera_om.cli.app import run as run
