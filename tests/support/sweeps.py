"""Sweeps for tests: short scenarios with samples, and what became of them."""

from __future__ import annotations

from pathlib import Path

import pyarrow.parquet as pq

from cube_sim.campaign.result import SweepResult
from cube_sim.campaign.sweep import sweep
from cube_sim.scenario import load
from support.scenario_files import FLIGHT, write

SAMPLES = """\
samples:
  count: 12
  vary:
    guidance.speed_m_s: {distribution: uniform, low: 0.2, high: 0.6}
    initial.position_m.1: {distribution: normal, mean: 0, std: 0.03}
    parameters.hull:mass: {distribution: uniform, gives: percent, low: -5, high: 5}
    control.faults: {distribution: choice, values: [told, diagnosed]}
  lost_thrusters: {losses: [0, 1, 2], choose: random, at_s: 0.1, until_s: 0.4}
"""
"""Some of which drift off by more than FLIGHT's check lets them."""


def written(folder: Path, samples: str = SAMPLES, before: str = FLIGHT, name: str = "swept.yaml") -> Path:
    """A scenario file with samples."""
    return write(folder, before + samples, name)


def swept(file: Path, out: Path, **options) -> SweepResult:
    """Its samples flown."""
    return sweep(load(file), out, **options)


def rows_of(out: Path) -> list[dict]:
    """The rows of a sweep that is flown, as plain data."""
    return pq.read_table(out / "rows.parquet").to_pylist()
