"""The table of mutations: with an effect switched off, its validation test fails; run by ``make mutations``.

That the tests pass with all effects on is what the default run says.
"""

import importlib.util
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

REASON = re.compile(r"^FAILED .* - (AssertionError|assert )", re.MULTILINE)
HERE = Path(__file__).resolve().parent
_spec = importlib.util.spec_from_file_location("plugin", HERE / "plugin.py")
plugin = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(plugin)


def run(test, root, mutation):
    """A test in a process of its own, mutated."""
    paths = [str(HERE), *filter(None, [os.environ.get("PYTHONPATH")])]
    here = os.environ | {"PYTHONPATH": os.pathsep.join(paths), "HERA_OM_MUTATION": mutation, "COLUMNS": "200"}
    command = [sys.executable, "-m", "pytest", "-p", "plugin", "-q", "-x", "-m", "", test]
    return subprocess.run(command, cwd=root, env=here, capture_output=True, text=True)


@pytest.mark.mutation
@pytest.mark.parametrize("name", plugin.MUTATIONS)
def test_the_validation_test_fails_without_the_effect(root, name):
    done = run(plugin.MUTATIONS[name].test, root, name)
    assert done.returncode == 1, done.stdout + done.stderr  # 1: tests ran and failed; 4 or 5: no such test
    assert REASON.search(done.stdout), done.stdout  # by its own comparison, not by an accident


@pytest.mark.parametrize("name", plugin.MUTATIONS)
def test_what_a_mutation_changes_is_there(name, root):
    mutation = plugin.MUTATIONS[name]
    path, test = mutation.test.split("::")
    assert f"def {test.partition('[')[0]}(" in (root / path).read_text()
    for place in mutation.places:
        module, attribute = place.split(":")
        assert hasattr(plugin.importlib.import_module(f"hera_om.physics.{module}"), attribute)
