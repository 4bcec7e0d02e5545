"""Commands that are printed work when they are pasted, however the program was called."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys

import pytest

from cube_sim.commands import output

SCRIPT = shutil.which("cube-sim", path=os.path.dirname(sys.executable))


@pytest.fixture
def called_as(monkeypatch, tmp_path):
    def line(argv0: str, *, on_path: bool) -> str:
        monkeypatch.setattr(sys, "argv", [argv0])
        monkeypatch.setenv("PATH", os.path.dirname(SCRIPT) if on_path else str(tmp_path))
        return output.to_paste("view", "logs/a run")

    return line


def test_a_program_on_the_path_is_called_by_its_name(called_as):
    assert called_as(SCRIPT, on_path=True) == "cube-sim view 'logs/a run'"


def test_a_program_that_is_not_is_called_as_it_was(called_as, tmp_path, monkeypatch):
    assert called_as(SCRIPT, on_path=False) == f"{SCRIPT} view 'logs/a run'"
    (tmp_path / "there").mkdir()
    (tmp_path / "there" / "cube-sim").symlink_to(SCRIPT)
    monkeypatch.chdir(tmp_path)
    assert called_as("there/cube-sim", on_path=False) == "there/cube-sim view 'logs/a run'"


def test_a_module_is_called_as_one(called_as):
    line = called_as("/somewhere/cube_sim/__main__.py", on_path=True)
    assert line == shlex.join([sys.executable, "-m", "cube_sim", "view", "logs/a run"])


def test_what_is_printed_after_the_examples_are_copied_is_found_again(tmp_path):
    """As pasted into the same shell, whose PATH does not know the program."""
    environment = {**os.environ, "PATH": "/usr/bin:/bin"}
    told = subprocess.run(
        [SCRIPT, "examples", "swimming"], cwd=tmp_path, env=environment, capture_output=True, text=True, check=True
    ).stdout.splitlines()[-1]
    pasted = told.removeprefix("fly one:  ").replace(" run ", " validate ")
    done = subprocess.run(
        ["sh", "-c", pasted], cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=300
    )
    assert (done.returncode, done.stdout.splitlines()[0]) == (0, "1 of 1 can be flown"), done.stderr
