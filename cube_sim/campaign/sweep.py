"""All samples of a scenario flown, each once, whoever flies them and however often the sweep is begun again."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Literal, NamedTuple

from cube_sim.campaign.cluster import on_cluster
from cube_sim.campaign.folder import WHOLE, Shard, SweepFolder, opened
from cube_sim.campaign.identity import identity_of
from cube_sim.campaign.processes import in_processes
from cube_sim.campaign.result import SweepResult
from cube_sim.campaign.sample_flight import FlownSample, Keep, Task
from cube_sim.campaign.sampling import SamplePlan
from cube_sim.campaign.threads import on_threads
from cube_sim.errors import SweepInterrupted
from cube_sim.many_flights import flies_in_python
from cube_sim.scenario import Scenario
from cube_sim.scenario.check_blocks import AnyCheck
from cube_sim.scenario.fleet import FleetScenario
from cube_sim.scenario.fleet_loading import AnyLoaded, LoadedFleet

WorkersAs = Literal["threads", "processes"]


class HowFar(NamedTuple):
    """How far a sweep is.

    Attributes:
        stored: so many samples are in its files: no kill takes them away.
        flown: so many are flown.
        wanted: of so many.
        failed: so many of those flown since it began have not passed.
    """

    stored: int
    flown: int
    wanted: int
    failed: int


def sweep(
    loaded: AnyLoaded,
    out: Path | None = None,
    *,
    workers: int | None = None,
    workers_as: WorkersAs | None = None,
    cluster: str | None = None,
    shard: Shard = WHOLE,
    keep: Keep = "none",
    resume: bool = False,
    limit_s: float | None = None,
    progress: Callable[[HowFar], None] | None = None,
) -> SweepResult:
    """Fly the samples of a scenario.

    Args:
        loaded: the scenario.
        out: folder for the rows; default: a new one in logs/.
        workers: how many samples fly at a time on this machine; default: as many as there are processors.
        workers_as: threads, or processes; default: threads where nothing of the user's is flown, as they need no
            time to start and share what all samples need; a process is all that a native crash ends.
        cluster: address of a Dask scheduler, tcp://host:port, whose workers fly instead.
        shard: fly this part of the samples alone.
        keep: of which samples a recording stays.
        resume: go on with what is in `out`.
        limit_s: so long a sample may take, of the clock [s]; then it is an ERROR. In processes whatever it does; on
            threads and on a cluster it is left at the end of a simulated second or ten.
        progress: called once in a while, and with every sample.

    Raises:
        ScenarioError: the samples are none that can be flown; nothing is.
        DirectoryError: `out` holds something else, or another sweep.
        SweepError: the disk is full, or gone; what was flown stays.
        SweepInterrupted: Ctrl-C, SIGTERM or SIGHUP; what was flown stays.
    """
    plan = SamplePlan(loaded)
    plan.require_possible()
    samples = shard.samples(plan.count)
    checks = list(_checks_of(loaded.scenario))
    folder = out if out is not None else _new_folder(loaded.scenario.name)
    head = head_of(loaded, plan)
    with opened(folder, shard, head, resume=resume, checks=checks) as rows:
        waiting = [k for k in samples if k not in rows.done]
        flown = _flown(Task(loaded, keep, folder.resolve(), limit_s), waiting, workers, workers_as, cluster)
        try:
            _take(flown, rows, len(samples), progress)
        except KeyboardInterrupt as interrupt:
            rows.flush()
            raise SweepInterrupted(folder, rows.stored, len(samples), interrupt) from None
        finally:
            rows.flush()
        whole = rows.finish()
    return SweepResult(folder, head, whole, part=shard.of > 1)


def _take(
    flown: Iterator[FlownSample], rows: SweepFolder, wanted: int, progress: Callable[[HowFar], None] | None
) -> None:
    """Take samples as they land."""
    landed, failed = len(rows.done), 0
    if progress is not None:
        progress(HowFar(rows.stored, landed, wanted, failed))
    for each in flown:
        landed, failed = landed + 1, failed + (each.verdict != "PASS")
        rows.append(each)
        if progress is not None:
            progress(HowFar(rows.stored, landed, wanted, failed))


def _flown(
    task: Task, samples: list[int], workers: int | None, workers_as: WorkersAs | None, cluster: str | None
) -> Iterator[FlownSample]:
    """The samples, as they land, by whoever is to fly them."""
    if not samples:
        return iter(())
    if cluster is not None:
        return on_cluster(task, samples, cluster)
    most = min(workers or os.cpu_count() or 1, len(samples))
    if (workers_as or usual_workers(task.loaded)) == "threads":
        return on_threads(task, samples, most)
    return in_processes(task, samples, most)


def usual_workers(loaded: AnyLoaded) -> WorkersAs:
    """Threads where all that is flown is compiled; processes for code of the user's own, and for several vehicles."""
    samples = loaded.scenario.samples
    drawn_by_own = samples is not None and samples.generator is not None
    own = isinstance(loaded, LoadedFleet) or flies_in_python(loaded) or drawn_by_own
    return "processes" if own else "threads"


def _checks_of(scenario: Scenario | FleetScenario) -> Mapping[str, AnyCheck]:
    """By what they are called in results."""
    if isinstance(scenario, FleetScenario):
        return scenario.all_checks
    return {check.title: check for check in scenario.checks}


def head_of(loaded: AnyLoaded, plan: SamplePlan) -> dict[str, Any]:
    """What sweep.json says."""
    scenario, block = loaded.scenario, plan.block
    return {
        "format": 1,
        "name": scenario.name,
        "scenario": str(loaded.path.resolve()),
        "settings": {override.path: override.value for override in loaded.overrides},
        "count": plan.count,
        "required": None if block.required is None else block.required.model_dump(),
        "checks": [
            {"name": name, "relation": check.bound.relation, "limit": check.bound.limit}
            for name, check in _checks_of(scenario).items()
        ],
        "varied": {path: distribution.model_dump() for path, distribution in block.vary.items()},
        "thrusters": list(plan.thrusters),
        "identity": identity_of(loaded).to_dict(),
    }


def _new_folder(name: str) -> Path:
    """``logs/<name>-sweep-<UTC time>``, or the first that is free behind it."""
    first = Path("logs", f"{name}-sweep-{datetime.now(UTC).strftime('%Y%m%dT%H%M%SZ')}")
    folder, count = first, 1
    while folder.exists():
        count += 1
        folder = first.with_name(f"{first.name}-{count}")
    return folder
