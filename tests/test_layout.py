"""The checkout as a whole: links, portable files, and layers that are really held."""

import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
FOLDERS = (".ci", "benchmarks", "docs", "hera_om", "notebooks", "tests")
TEXT = {"", *".cfg .cff .csv .html .ipynb .json .lock .md .py .toml .txt .yaml .yml".split()}
MACHINE_PATH = re.compile(r"(?<![\w.~/])/(?:home|root|work|tmp|opt|Users|mnt)/\w|\b[A-Z]:\\\w|file://")


def _texts():
    """Every text file that a clone brings, without what runs leave behind."""
    files = [path for path in ROOT.iterdir() if path.is_file()]
    for folder in FOLDERS:
        files += [path for path in (ROOT / folder).rglob("*") if path.is_file()]
    return [path for path in files if path.suffix in TEXT and not {"__pycache__", ".git"} & set(path.parts)]


def _run(tool: str, *arguments: str, cwd: Path, stdin: str | None = None) -> subprocess.CompletedProcess:
    """Run a tool of this environment."""
    command = [str(Path(sys.executable).with_name(tool)), *arguments]
    return subprocess.run(command, cwd=cwd, input=stdin, capture_output=True, text=True)


@pytest.mark.parametrize("name", ["components", "models"])
def test_links_at_the_root_show_the_package(name):
    link = ROOT / name
    assert link.is_symlink()
    assert os.readlink(link) == f"hera_om/{name}", "the link must be relative, or a clone breaks it"
    assert link.resolve() == ROOT / "hera_om" / name


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("cd /" + "home/someone/x", True),
        ("'/" + "tmp/x'", True),
        ("C:" + r"\Users", True),
        ("https://example.org/home/page", False),
        ("a and/or b, 1/opt/2", False),
    ],
)
def test_a_machine_path_is_recognised(text, found):
    assert bool(MACHINE_PATH.search(text)) is found


def test_no_file_names_a_path_of_some_machine():
    named = [
        f"{path.relative_to(ROOT)}:{number}: {line.strip()[:80]}"
        for path in _texts()
        if path != Path(__file__).resolve()
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1)
        if MACHINE_PATH.search(line)
    ]
    assert not named, "\n".join(named)


def test_the_lock_is_exact_and_names_no_index():
    lines = [line for line in (ROOT / "requirements.lock").read_text().splitlines() if not line.startswith("#")]
    assert lines
    for line in lines:
        assert re.fullmatch(r"[a-z0-9-]+==[0-9][0-9a-z.]*", line), line


def test_notebooks_are_stored_without_outputs():
    for path in ROOT.glob("notebooks/**/*.ipynb"):
        for cell in json.loads(path.read_text(encoding="utf-8"))["cells"]:
            assert not cell.get("outputs") and cell.get("execution_count") is None, path.name


@pytest.mark.parametrize("statement", ["import components", "from models import x", "import models.trim"])
def test_ruff_bans_imports_through_the_links(statement):
    arguments = ("check", "--select", "TID251", "--stdin-filename", "hera_om/x.py", "-")
    done = _run("ruff", *arguments, cwd=ROOT, stdin=statement)
    assert done.returncode == 1 and "TID251" in done.stdout


@pytest.mark.parametrize(
    ("module", "statement"),
    [
        (None, ""),
        ("core", "import hera_om.aircraft"),
        ("physics", "import openmdao.api"),
        ("physics", "from hera_om import aircraft"),
        ("aircraft", "import hera_om.physics"),
        ("components", "import hera_om.models"),
        ("post", "import hera_om.studies"),
        ("models", "def late():\n    import hera_om.post"),
    ],
)
def test_import_linter_holds_the_layers(tmp_path, module, statement):
    shutil.copytree(ROOT / "hera_om", tmp_path / "hera_om", ignore=shutil.ignore_patterns("__pycache__"))
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    if module:
        (tmp_path / "hera_om" / module / "intruder.py").write_text(statement + "\n")
    done = _run("lint-imports", "--no-cache", cwd=tmp_path)
    broken = "BROKEN" in done.stdout
    assert broken is bool(module), done.stdout + done.stderr
