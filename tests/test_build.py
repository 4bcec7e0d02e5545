"""Which code runs: a digest that follows the source and nothing else, and the commit."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

import cube_sim
from cube_sim.build import commit, source_digest

PACKAGE = Path(cube_sim.__file__).parent


@pytest.fixture
def package(tmp_path) -> Path:
    folder = tmp_path / "top" / "cube_sim"
    (folder / "part").mkdir(parents=True)
    (folder / "a.py").write_text("A = 1\n")
    (folder / "part" / "b.py").write_text("B = 2\n")
    return folder


def test_the_digest_is_of_the_source_and_of_nothing_else(package, tmp_path):
    first = source_digest(package)
    assert first == source_digest(shutil.copytree(package, tmp_path / "elsewhere" / "copy"))
    (package / "__pycache__").mkdir()
    (package / "__pycache__" / "a.cpython-311.pyc").write_bytes(b"machine")
    (package / "examples").mkdir()
    (package / "examples" / "mission.py").write_text("of the user")
    assert source_digest(package) == first
    (package / "a.py").write_text("A = 2\n")
    second = source_digest(package)
    (package / "a.py").rename(package / "c.py")
    assert len({first, second, source_digest(package), source_digest()}) == 4
    assert source_digest() == source_digest(PACKAGE)


def test_the_commit_is_told_and_whether_the_code_was_edited_since(package):
    def git(*arguments):
        names = ["-c", "user.name=n", "-c", "user.email=e@example.org"]
        done = subprocess.run(
            ["git", *names, *arguments], cwd=package.parent, check=True, capture_output=True, text=True
        )
        return done.stdout.strip()

    assert commit(package) is None
    git("init", "-q")
    assert commit(package) is None  # nothing is committed yet
    git("add", "-A")
    git("commit", "-qm", "first")
    (package.parent / "notes.txt").write_text("beside the code")
    assert commit(package) == git("rev-parse", "HEAD")
    (package / "a.py").write_text("A = 3\n")
    assert commit(package) == f"{git('rev-parse', 'HEAD')} + changes"
    git("checkout", "-q", "--", ".")
    (package / "new.py").write_text("")
    assert commit(package).endswith(" + changes")
