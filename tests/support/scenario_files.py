"""Scenario files for tests: a small valid one, and what is wrong with others."""

from __future__ import annotations

from pathlib import Path

import pytest

from cube_sim.errors import ScenarioError
from cube_sim.scenario import load
from support.places import CUBE

MINIMAL = """\
schema_version: 1
name: short_line
model: hull.xml
duration_s: 10
path: {type: line, start_m: [0, 0, -5], end_m: [4, 0, -5]}
guidance: {speed_m_s: 0.4}
checks:
  - {kind: path_end, reach_m: 0.5}
"""

# Half a second of the real vehicle, enough to be judged.
FLIGHT = f"""\
schema_version: 1
name: short_flight
model: {CUBE}
duration_s: 0.5
path: {{type: line, start_m: [0, 0, -5], end_m: [4, 0, -5]}}
initial: {{position_m: [0, 0, -5]}}
guidance: {{speed_m_s: 0.4}}
checks:
  - {{kind: signal, signal: path_error.cross_track, statistic: max, at_most: 0.05}}
  - {{kind: allowed_forces}}
"""


def write(folder: Path, text: str | bytes = MINIMAL, name: str = "mission.yaml") -> Path:
    """Save a scenario file beside an empty MJCF file."""
    (folder / "hull.xml").write_text("<mujoco/>\n")
    path = folder / name
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


def mistakes(path: Path, overrides: dict[str, object] | None = None) -> list[str]:
    """The mistakes in a scenario file, without its folder's name."""
    with pytest.raises(ScenarioError) as caught:
        load(path, overrides)
    assert str(caught.value) == "\n".join(caught.value.mistakes)
    return [line.replace(f"{path.parent}/", "") for line in caught.value.mistakes]
