"""The command line as tests call it: in a process of its own, or in this one."""

from __future__ import annotations

import subprocess
import sys

import pytest


def cube_sim(*arguments, cwd, **options) -> subprocess.CompletedProcess[str]:
    """Call it as a shell does."""
    command = [sys.executable, "-m", "cube_sim", *map(str, arguments)]
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True, timeout=120, **options)


def call(monkeypatch, capsys, *arguments) -> tuple[int, str, str]:
    """Call the same entry in this process, where the simulation is loaded once for many calls.

    Returns:
        Exit code, stdout, stderr.
    """
    from cube_sim.commands.cli import main

    monkeypatch.setattr(sys, "argv", ["cube-sim", *map(str, arguments)])
    with pytest.raises(SystemExit) as ended:
        main()
    captured = capsys.readouterr()
    return ended.value.code, captured.out, captured.err
