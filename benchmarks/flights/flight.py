"""One mission, or one flight of the catalogue, from its plan to its figures; runs in a process of its own."""

from __future__ import annotations

import shutil
import time
from dataclasses import asdict
from pathlib import Path
from typing import Any

from flights.forecast import forecast
from flights.judging import judged
from flights.mission import Mission, written
from flights.plan import Plan

Row = dict[str, Any]


def flown(plan: Plan, out: Path, *, flown_anyway: bool, keep: bool) -> Row:
    """Draw, forecast, fly and judge a mission.

    Args:
        plan: of the mission.
        out: folder under which it gets a folder of its own; mission.yaml and the model stay there.
        flown_anyway: fly it also when the analysis says no.
        keep: leave the recording, too.
    """
    folder = out / str(plan.seed)
    folder.mkdir(parents=True, exist_ok=True)
    return fly(written(plan, folder), folder, flown_anyway=flown_anyway, keep=keep)


def fly(mission: Mission, folder: Path, *, flown_anyway: bool, keep: bool) -> Row:
    """Forecast, fly and judge what is written in a folder."""
    import cube_sim
    from cube_sim.recording.reading import read_recording

    started = time.perf_counter()
    expected = forecast(
        folder / "model.xml",
        lost=mission.lost,
        weak=mission.weak,
        stuck=mission.stuck,
        speed_m_s=mission.through_water_m_s,
        planar=mission.planar,
        steep=mission.steep,
    )
    row: Row = asdict(mission.plan) | {
        "speed_m_s": mission.scenario["guidance"]["speed_m_s"],
        "through_water_m_s": mission.through_water_m_s,
        "from_s": mission.from_s,
        "faults": _faults(mission),
        "forecast": expected.flies,
        "forecast_reason": expected.reason,
        "analysis_s": time.perf_counter() - started,
    }
    if not (expected.flies or flown_anyway):
        return row | {"flown": False}
    run_folder = folder / "run"
    shutil.rmtree(run_folder, ignore_errors=True)
    run = cube_sim.run(folder / "mission.yaml", out=run_folder)
    row |= judged(run.signals, mission.scenario, mission.from_s, mission.planar)
    log = read_recording(run_folder / "run.mcap").log
    row["log"] = [f"{line.t:.2f} {line.level} {line.text}" for line in log if line.level != "INFO"][:12]
    if not keep:
        shutil.rmtree(run_folder)
    return row | {"flown": True, "took_s": time.perf_counter() - started}


def _faults(mission: Mission) -> str:
    """What is wrong with the thrusters at the end, in words."""
    said = [f"{name} dead" for name in mission.lost]
    said += [f"{name} weak {share:.2f}" for name, share in mission.weak.items()]
    said += [f"{name} stuck {force:.0f} N" for name, force in mission.stuck.items()]
    return ", ".join(said)
