"""Which code of cube_sim runs: a digest of its source, and the commit where it runs from a checkout."""

from __future__ import annotations

import os
import subprocess
from hashlib import sha256
from pathlib import Path

_PACKAGE = Path(__file__).resolve().parent
_SHIPPED = "examples"
"""Folder that a wheel has inside the package and a checkout beside it."""


def source_digest(package: Path = _PACKAGE) -> str:
    """SHA-256 over every Python file of a package, by its path in it, whatever its folder is called.

    Args:
        package: its folder.
    """
    files = {file.relative_to(package).as_posix(): file for file in package.rglob("*.py")}
    digest = sha256()
    for name in sorted(name for name in files if not name.startswith(f"{_SHIPPED}/")):
        digest.update(f"{name}\0".encode() + files[name].read_bytes() + b"\0")
    return digest.hexdigest()


def commit(package: Path = _PACKAGE) -> str | None:
    """The commit of the checkout a package stands at the top of; ``+ changes`` behind it where it was edited since.

    Args:
        package: its folder.

    Returns:
        None where there is no checkout, or no git.
    """
    if not (package.parent / ".git").exists():
        return None
    command = ["git", "status", "--porcelain=v2", "--branch", "--untracked-files=all", "--", package.name]
    try:
        said = subprocess.run(
            command,
            cwd=package.parent,
            env={**os.environ, "GIT_OPTIONAL_LOCKS": "0"},
            stdin=subprocess.DEVNULL,
            capture_output=True,
            text=True,
            timeout=5.0,
        )
    except (OSError, subprocess.SubprocessError):
        return None
    lines = said.stdout.splitlines()
    found = next((line.split()[-1] for line in lines if line.startswith("# branch.oid ")), "")
    if said.returncode or len(found) < 40:
        return None
    edited = any(not line.startswith("#") and not line.startswith("! ") for line in lines)
    return f"{found} + changes" if edited else found
