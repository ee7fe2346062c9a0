"""Where a result came from: versions, revision and platform, for the record of a run."""

import platform
import subprocess
from importlib import metadata
from pathlib import Path

PACKAGES = ("hera-om", "openmdao", "jax", "jaxlib", "numpy", "scipy", "smt", "pydantic")
"""Distributions whose version can change a number."""


def provenance() -> dict[str, str | bool | None]:
    """Versions, git revision and platform of this process, as plain values that JSON takes.

    Nothing heavy is imported: versions come from the metadata of the installed distributions.

    Returns:
        One key for each of ``PACKAGES`` (``hera-om`` as ``hera_om``), ``python``, ``platform``, ``revision``
        and ``modified``. A version is ``None`` where the distribution is not installed; ``revision`` and
        ``modified`` (the work tree differs from the revision) are ``None`` outside a checkout of the project.
    """
    record: dict[str, str | bool | None] = {name.replace("-", "_"): _version(name) for name in PACKAGES}
    record["python"] = platform.python_version()
    record["platform"] = platform.platform()
    checkout = _checkout()
    revision = _git(checkout, "rev-parse", "HEAD") if checkout else None
    changes = ("status", "--porcelain", "--untracked-files=no")
    status = _git(checkout, *changes) if checkout and revision else None
    return record | {"revision": revision, "modified": None if status is None else bool(status)}


def _version(name: str) -> str | None:
    """Version of an installed distribution."""
    try:
        return metadata.version(name)
    except metadata.PackageNotFoundError:
        return None


def _checkout() -> Path | None:
    """Root of the project's checkout, or None where the package was installed from a wheel.

    A wheel may well be installed below somebody else's repository; that one's revision is not ours.
    """
    root = Path(__file__).resolve().parents[2]
    if not (root / "pyproject.toml").is_file():
        return None
    top = _git(root, "rev-parse", "--show-toplevel")
    return root if top is not None and Path(top).resolve() == root else None


def _git(folder: Path, *arguments: str) -> str | None:
    """Output of a git command, or None where git is missing, slow or refuses."""
    try:
        done = subprocess.run(
            ["git", "-C", str(folder), *arguments],
            capture_output=True,
            text=True,
            timeout=10,
            check=True,
        )
    except (OSError, subprocess.SubprocessError):
        return None
    return done.stdout.strip()
