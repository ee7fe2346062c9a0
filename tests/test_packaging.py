"""The wheel: what is in it, and that it imports where nothing of the checkout is in reach."""

import json
import shutil
import subprocess
import sys
import zipfile
from email.parser import Parser

import pytest

LEFT_BEHIND = shutil.ignore_patterns(".*", "runs", "build", "dist", "*.egg-info", "*_out", "__pycache__")

IMPORT_ALL = """
import importlib, json, pkgutil, sys
from importlib.resources import files
sys.path.insert(0, sys.argv[1])
import hera_om
names = [module.name for module in pkgutil.walk_packages(hera_om.__path__, "hera_om.")]
for name in names:
    importlib.import_module(name)
data = files("hera_om.aircraft") / "data"
print(json.dumps({
    "files": sorted({sys.modules[name].__file__ for name in names}),
    "data": sorted(entry.name for entry in data.iterdir()) if data.is_dir() else [],
}))
"""


@pytest.fixture(scope="module")
def wheel(root, tmp_path_factory):
    """The wheel of a copy of the checkout, links and all, so that no build folder is left in ours."""
    source = tmp_path_factory.mktemp("source") / "checkout"
    shutil.copytree(root, source, symlinks=True, ignore=LEFT_BEHIND)
    out = tmp_path_factory.mktemp("dist")
    command = [sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", str(out), str(source)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    (path,) = out.glob("*.whl")
    with zipfile.ZipFile(path) as archive:
        yield archive


def test_only_the_package_is_at_the_top(wheel):
    top = {name.split("/")[0] for name in wheel.namelist()}
    (info,) = (name for name in top if name.endswith(".dist-info"))
    assert top == {"hera_om", info}


def test_the_wheel_holds_every_module_and_data_file(wheel, root):
    package = root / "hera_om"
    expected = {
        path.relative_to(root).as_posix()
        for pattern in ("*.py", "py.typed", "*.toml")
        for path in package.rglob(pattern)
    }
    packed = {name for name in wheel.namelist() if name.startswith("hera_om/")}
    assert packed == expected
    assert "hera_om/aircraft/data/hera_like.toml" in packed


def test_metadata(wheel):
    def read(name: str) -> str:
        (path,) = (entry for entry in wheel.namelist() if entry.endswith(f".dist-info/{name}"))
        return wheel.read(path).decode()

    metadata = Parser().parsestr(read("METADATA"))
    assert metadata["Name"] == "hera-om"
    assert metadata["License-Expression"] == "Apache-2.0"
    assert "hera-om = hera_om.cli:run" in read("entry_points.txt")
    assert "Apache License" in read("licenses/LICENSE")


def test_it_imports_from_an_empty_folder(wheel, root, tmp_path):
    site, empty = tmp_path / "site", tmp_path / "empty"
    empty.mkdir()
    wheel.extractall(site)
    done = subprocess.run(
        [sys.executable, "-I", "-c", IMPORT_ALL, str(site)], cwd=empty, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert found["files"] and all(path.startswith(str(site)) for path in found["files"])
    assert found["data"] == sorted(path.name for path in (root / "hera_om/aircraft/data").glob("*.toml"))
    assert not any(empty.iterdir()), "importing wrote into the working folder"
