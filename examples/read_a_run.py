"""Fly a scenario, read its recording back, and compute a figure of your own beside the verdict's.

    python examples/read_a_run.py [run.mcap]

With a recording named, it is read instead of flying one; its verdict.json is looked for beside it.
"""

import json
import sys
from pathlib import Path

import numpy as np

import cube_sim
from cube_sim.recording.reading import read_recording

SCENARIO = Path(__file__).parents[1] / "scenarios" / "cube_track.yaml"


def main() -> None:
    if len(sys.argv) > 1:
        file = Path(sys.argv[1])
    else:
        print(f"flying {SCENARIO.name} ...")
        file = cube_sim.run(SCENARIO, out="logs/example").directory / "run.mcap"

    recording = read_recording(file)
    signals = recording.signals  # "channel.field" -> (n, 1 + width), column 0 the time [s]
    print(f"\n{file}: {recording.vehicle}, {len(signals)} signals, the same bits the run had in memory")
    for channel in recording.channels[2:4]:
        for field in channel.fields:
            print(f"  {channel.name + '.' + field.name:20}{field.width} x [{field.unit}]  {field.doc}")
    for line in recording.log[:3]:
        print(f"  {line.t:6.2f} s  {line.level}: {line.text}")

    # What a check says, computed again.
    time, cross_track = signals["path_error.cross_track"].T
    own = cross_track[time >= 25.0].max()
    verdict = json.loads(file.with_name("verdict.json").read_text(encoding="utf-8"))
    print(f"\nverdict {verdict['verdict']}")
    for check in verdict["checks"]:
        print(f"  {check['name']}: {check['value']:.6g} {check['relation']} {check['limit']:g}")
    print(f"cross-track error from 25 s on, by our own account: at most {own:.6g} m")

    # What no check says: how often the thrusters change direction, and what a metre of way costs.
    side = np.sign(signals["thrusters.force_demanded"][:, 1:])
    reversals = int((side[1:] * side[:-1] < 0.0).sum())
    way = np.linalg.norm(np.diff(signals["pose.position"][:, 1:], axis=0), axis=1).sum()
    energy = signals["power.energy"][-1, 1]
    print(
        f"{reversals} reversals of {side.shape[1]} thrusters in {time[-1]:g} s; {energy / way:.0f} J per metre of way"
    )


if __name__ == "__main__":
    main()
