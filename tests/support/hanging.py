"""The ballasted vehicle with joints that nobody commands: a pendulum, a lamp on a ball, a battery on a spring."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from support.ballasted import ballasted

PENDULUM = """<body name="pendulum" pos="0 0 -0.1">
        <joint name="swing" axis="0 1 0" damping="0.01"/>
        <inertial pos="0 0 -0.3" mass="0.5" diaginertia="0.001 0.001 0.001"/>
        <body name="lamp" pos="0 0 -0.6">
          <joint name="socket" type="ball" damping="0.001"/>
          <inertial pos="0.02 0 -0.05" mass="0.1" diaginertia="0.0001 0.0001 0.0001"/>
        </body>
      </body>
      <body name="battery">"""
HANGING = {"setpoints": {}, "events": [], "duration_s": 4, "checks": [{"kind": "allowed_forces"}]}


def hanging(folder: Path, **changes: Any) -> dict[str, Any]:
    """A mission of it.

    Args:
        folder: for the model.
        changes: keys in place of its own.
    """
    scenario = ballasted(folder, **{**HANGING, **changes})
    model = folder / "ballasted.xml"
    text = model.read_text().replace('<body name="battery">', PENDULUM)
    servo = text.index('<position name="battery"')
    text = text[:servo] + text[text.index("/>", servo) + 2 :]
    model.write_text(text.replace('range="-0.3 0.3"', 'stiffness="20" damping="4"'))
    return scenario
