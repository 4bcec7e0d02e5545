"""Scenarios of several vehicles for tests, and their flights."""

from __future__ import annotations

from pathlib import Path

from cube_sim.flight import FleetLoop, prepared_fleet
from cube_sim.recording.signal_store import SignalStore
from cube_sim.scenario.fleet_loading import LoadedFleet, load_any
from support.places import MODELS

PAIR = f"""\
schema_version: 1
name: pair
duration_s: 12
seed: 4
model: {MODELS / "cube.xml"}
current_m_s: [0.1, 0, 0]
guidance: {{speed_m_s: 0.3}}
path: {{type: line, start_m: [0, 0, -5], end_m: [6, 0, -5]}}
vehicles:
  leader:
    initial: {{position_m: [0, 0.2, -5]}}
    checks:
      - {{kind: signal, signal: path_error.cross_track, statistic: final, at_most: 0.05}}
  follower:
    path: {{type: circle, centre_m: [0, 5, -5], radius_m: 2}}
    guidance: {{speed_m_s: 0.25}}
    initial: {{position_m: [2, 4, -5]}}
checks:
  - {{kind: distance, between: [follower, leader], statistic: min, at_least: 1.0}}
  - {{kind: signal, signal: follower/path_error.cross_track, statistic: final, at_most: 0.05}}
"""


def write(folder: Path, text: str = PAIR) -> Path:
    """A scenario file in a folder."""
    path = folder / "pair.yaml"
    path.write_text(text)
    return path


def loaded_fleet(path: Path, overrides=None) -> LoadedFleet:
    """A file that is of several vehicles."""
    loaded = load_any(path, overrides)
    assert isinstance(loaded, LoadedFleet)
    return loaded


def fly(loaded: LoadedFleet) -> tuple[FleetLoop, SignalStore]:
    """Fly to the end, with all rows in memory."""
    mission = prepared_fleet(loaded)
    store = SignalStore(mission.channels)
    loop = FleetLoop(mission, store)
    loop.fly_to_its_end()
    return loop, store
