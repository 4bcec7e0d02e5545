"""Scenarios with code of the user's own in them."""

from __future__ import annotations

from pathlib import Path
from textwrap import dedent

from support.scenario_files import FLIGHT

PID = """\
import numpy as np


def pid(setup, kp=2.0, ki=0.2):
    M, total = setup.dynamics.total_mass, np.zeros(6)

    def law(aim):
        nonlocal total
        total = total + aim.velocity_error * aim.dt
        turn = np.concatenate([np.zeros(3), aim.error[3:]])
        return M @ (kp * (aim.velocity_error + turn) + ki * total)

    return law
"""
"""A law that remembers something."""


def scenario_with(folder: Path, source: str, **changes: object) -> Path:
    """A scenario file of half a second beside own.py with a source in it, and keys that take a block's place."""
    (folder / "own.py").write_text(dedent(source))
    path = folder / "own.yaml"
    path.write_text("".join([FLIGHT, *(f"{key}: {value}\n" for key, value in changes.items())]))
    return path
