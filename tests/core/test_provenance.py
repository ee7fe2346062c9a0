"""The record of where a result came from."""

import json
import platform
import shutil
import subprocess
import sys
from importlib import metadata
from pathlib import Path

import pytest

from hera_om.core import provenance as module
from hera_om.core.provenance import PACKAGES, provenance


def test_versions_are_those_installed_and_json_takes_them():
    record = json.loads(json.dumps(provenance()))
    for name in ("openmdao", "jax", "numpy", "scipy", "smt"):
        assert record[name] == metadata.version(name)
    assert record["python"] == platform.python_version()
    assert set(record) == {name.replace("-", "_") for name in PACKAGES} | {
        "python",
        "platform",
        "revision",
        "modified",
    }


def test_nothing_heavy_is_imported():
    code = (
        "import sys; from hera_om.core.provenance import provenance; provenance();"
        "print(sorted({'jax', 'numpy', 'openmdao', 'scipy', 'smt', 'pydantic'} & set(sys.modules)))"
    )
    root = Path(module.__file__).parents[2]
    done = subprocess.run([sys.executable, "-c", code], cwd=root, capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_a_missing_distribution_has_no_version():
    assert module._version("hera-om-no-such-distribution") is None


@pytest.fixture
def checkout(tmp_path, monkeypatch):
    """A committed repository with the module's file at the place it has in ours."""
    if shutil.which("git") is None:
        pytest.skip("git is not installed")
    file = tmp_path / "hera_om" / "core" / "provenance.py"
    file.parent.mkdir(parents=True)
    file.write_text("")
    (tmp_path / "pyproject.toml").write_text("")
    who = ["-c", "user.name=n", "-c", "user.email=e@example.org", "-c", "commit.gpgsign=false"]
    for arguments in (["init", "-q"], ["add", "."], [*who, "commit", "-q", "-m", "first"]):
        subprocess.run(["git", *arguments], cwd=tmp_path, check=True)
    monkeypatch.setattr(module, "__file__", str(file))
    return tmp_path


def test_revision_and_modification_of_a_checkout(checkout):
    record = provenance()
    assert isinstance(record["revision"], str) and len(record["revision"]) == 40
    assert record["modified"] is False
    (checkout / "pyproject.toml").write_text("changed")
    assert provenance()["modified"] is True


def test_the_revision_of_a_foreign_repository_is_not_taken(checkout, monkeypatch):
    inner = checkout / "site-packages"
    file = inner / "hera_om" / "core" / "provenance.py"
    file.parent.mkdir(parents=True)
    file.write_text("")
    monkeypatch.setattr(module, "__file__", str(file))
    for pyproject in (
        False,
        True,
    ):  # a wheel in somebody's environment; a copy of our tree in their repository
        if pyproject:
            (inner / "pyproject.toml").write_text("")
        record = provenance()
        assert record["revision"] is None and record["modified"] is None


def test_without_git_there_is_no_revision(checkout, monkeypatch):
    monkeypatch.setenv("PATH", "")
    assert provenance()["revision"] is None
