"""A recorded run that nobody flew: signals made here, so that what a reader of runs shows of them is known."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from cube_sim.recording.channels import channel_table
from cube_sim.recording.header import RunHeader
from cube_sim.recording.navigation_channels import navigation_channels
from cube_sim.recording.reading import NO_END, Recording
from cube_sim.run_log import LogLine
from cube_sim.runs.recorded_run import RecordedRun

THRUSTERS = ("T1", "T2", "T3")
SATURATED_S = 6.0, 7.0
"""When T3 is at its upper limit [s]."""
LIMIT_M = 0.5
"""Of the cross-track error, which is beyond it from 6.2 s to 7 s, most of all at 6.6 s, by 0.4 m."""

RESOLVED = """\
schema_version: 1
name: {name}
description: {description}
model: model/hull.xml
duration_s: 10.0
path: {{type: line, start_m: [0, 0, -5], end_m: [4, 0, -5]}}
guidance: {{speed_m_s: 0.4}}
control: {{velocity_time_s: 0.7}}
events:
  - {{kind: thrusters, at_s: 2.0, thrusters: [T1], state: dead}}
checks:
  - {{kind: signal, name: cross-track error, signal: path_error.cross_track, statistic: max, at_most: 0.5, from_s: 1.0}}
  - {{kind: allowed_forces}}
"""


def synthetic_run(
    *,
    name: str = "made_up",
    description: str = "none",
    complete: bool = True,
    verdict: object = "FAIL",
    until_s: float = 10.0,
    noise: float = 0.0,
    navigated: bool = False,
    log: tuple[LogLine, ...] = (LogLine(2.0, "WARNING", "T1: dead"),),
) -> RecordedRun:
    """Ten seconds at 50 Hz: T1 dies at 2 s, seen at 2.5 s; T3 saturates from 6 s to 7 s, and the error grows.

    Args:
        name: of the scenario.
        description: of the scenario, one word of YAML.
        complete: whether the record has its end.
        verdict: what verdict.json says; None for no such file.
        until_s: how far the rows go [s].
        noise: added to the forces of T2 [N].
        navigated: whether it has an estimate, off by 0.3 m in y, and position fixes twice a second, of which the one
            at 5 s was kept out.
        log: what was said.
    """
    t = np.arange(round(until_s * 50) + 1) / 50.0
    table = channel_table(THRUSTERS, 4, ("EXACT", "CLOSEST"), ("HOLONOMIC", "TRIM"))
    if navigated:
        table += navigation_channels({"position": 2.0})
    signals = {channel.name: np.zeros((len(t), 1 + channel.width)) for channel in table}
    limits = np.tile([-40.0, -2.0, 2.0, 50.0], 3)
    lost = np.concatenate([np.zeros(4), limits[4:]])
    signals["actuation"] = np.array([[0.0, *np.zeros(18), *limits], [2.5, *np.zeros(18), *lost]])
    signals["path"] = np.array([[0.0, 0, 0, -5, 1, 0, -5, 2, 0, -5, 4, 0, -5]])
    for channel in table:
        if channel.name not in ("actuation", "path"):
            signals[channel.name][:, 0] = t
    inside = (t >= SATURATED_S[0]) & (t < SATURATED_S[1])
    thrusters = signals["thrusters"]
    thrusters[:, 2] = 10.0 + noise * np.sin(40.0 * t)
    thrusters[:, 3] = np.where(inside, 50.0, 5.0)
    thrusters[:, 7:10] = thrusters[:, 1:4]
    signals["path_error"][:, 4] = np.where((t >= 6.2) & (t <= 7.0), 0.9 - np.abs(t - 6.6), 0.01)
    signals["health"][:, 1:7] = 1.0
    signals["health"][t >= 2.0, 1] = 0.0
    signals["health"][t >= 2.5, 4] = 0.0
    signals["pose"][:, 1:5] = np.column_stack([0.4 * t, 0.1 * np.sin(t), np.full(len(t), -5.0), np.ones(len(t))])
    signals["power"][:, 1:4] = 20.0
    if navigated:
        signals["navigation_error"][:, 2] = 0.3
        signals["navigation"][:, 14:17] = 0.2
        fixes = signals["sensor_position"] = signals["sensor_position"][::25]
        fixes[:, 5:8] = [0.1, -0.1, 0.2]
        fixes[:, 8] = np.where(fixes[:, 0] == 5.0, 40.0, 2.0)
        fixes[:, 9] = fixes[:, 0] == 5.0
    header = RunHeader(
        scenario="",
        resolved=RESOLVED.format(name=name, description=description),
        model="model/hull.xml",
        inputs={"model/hull.xml": b"<mujoco/>"},
        versions={"cube-sim": "0.1.0"},
        seed=3,
    )
    rows = {name: values[values[:, 0] <= until_s] for name, values in signals.items()}
    rows = {name: values for name, values in rows.items() if len(values)}
    said = None if verdict is None else {"verdict": verdict}
    recording = Recording(header, "hull", table, rows, log, flaw="" if complete else NO_END)
    return RecordedRun(Path("nowhere/run.mcap"), recording, said)
