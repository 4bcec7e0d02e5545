"""Many flights of one scenario at once, on threads: compiled loops that need no interpreter."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import FIRST_EXCEPTION, ThreadPoolExecutor, wait
from dataclasses import dataclass, replace
from math import nan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cube_sim.checks import evaluate
from cube_sim.errors import ScenarioError
from cube_sim.flight import Loop, prepared
from cube_sim.mission.own.given import AnyScenario, loaded_with
from cube_sim.recording.channels import units_of
from cube_sim.recording.signal_store import SignalStore
from cube_sim.run_log import LogLine
from cube_sim.scenario import Loaded
from cube_sim.vehicle.plugin.hook import install
from cube_sim.verdict import CheckResult, EarlyEnd, Verdict, overall

Signals = Mapping[str, NDArray[np.float64]]


@dataclass(frozen=True)
class FlightOutcome:
    """What became of one of many flights.

    Attributes:
        variation: what was varied: dotted path -> value.
        verdict: PASS, FAIL or ERROR, as for `run`.
        checks: one result per check of the scenario.
        simulated_s: simulated time from the start to the end [s].
        ended_early: when and why it ended before its time; None if it did not.
        log: what was said at the level WARNING or above, in the order of time.
        statistics: of the whole flight, see `statistics_of`.
        signals: those asked for, "channel.field" -> (n, 1 + width), column 0 the time [s].
    """

    variation: Mapping[str, Any]
    verdict: Verdict
    checks: tuple[CheckResult, ...]
    simulated_s: float
    ended_early: EarlyEnd | None
    log: tuple[LogLine, ...]
    statistics: Mapping[str, float]
    signals: Signals


def fly_many(
    scenario: AnyScenario,
    variations: Iterable[Mapping[str, Any]],
    *,
    threads: int | None = None,
    signals: Sequence[str] = (),
    confirm: bool = False,
) -> list[FlightOutcome]:
    """Fly a scenario once for each variation of it, to the bit as each would be flown alone.

    Nothing is written. Loops that compiled code flies run beside each other; what takes Python (own code in a
    scenario, thruster faults at the moment they are found) waits for its turn.

    Args:
        scenario: a file, what would stand in one, or a loaded one.
        variations: dotted path -> value in place of the scenario's, one mapping for each flight, e.g.
            ``[{"seed": k} for k in range(1000)]``.
        threads: how many flights at a time; as many as there are processors unless told.
        signals: names of the signals to keep, e.g. ``["pose.position"]``.
        confirm: whether ProxQP confirms every answer of the search where the scenario says so. It changes no bit of
            a flight, and takes Python at every tick.

    Returns:
        One outcome for each variation, in their order.

    Raises:
        ScenarioError: a variation cannot be flown; which one it is stands first. None is flown then whose mistake
            shows in the scenario itself.
        ValueError: threads below 1, or a signal that is not recorded.
    """
    if threads is not None and threads < 1:
        raise ValueError(f"threads is {threads}; at least one flies")
    if isinstance(signals, str):
        raise ValueError(f"signals takes a list of names, not {signals!r}")
    varied = [_checked(index, variation) for index, variation in enumerate(variations)]
    loaded = [_loaded(scenario, index, variation, confirm) for index, variation in enumerate(varied)]
    install()
    stop = threading.Event()
    with ThreadPoolExecutor(threads or os.cpu_count() or 1) as pool:
        pairs = enumerate(zip(loaded, varied, strict=True))
        asked = [pool.submit(_outcome, index, *pair, signals, stop) for index, pair in pairs]
        try:
            wait(asked, return_when=FIRST_EXCEPTION)
            for each in asked:
                if each.done() and (failure := each.exception()) is not None:
                    raise failure
            return [each.result() for each in asked]
        finally:
            stop.set()  # whoever is in the air when one fails, or on Ctrl-C, lands within a simulated second or ten
            pool.shutdown(wait=False, cancel_futures=True)


def statistics_of(signals: Signals) -> dict[str, float]:
    """A flight in numbers, from its recorded signals; NaN where nothing was recorded.

    Returns:
        "cross_track_rms_m", "cross_track_max_m": distance across the path; at a point, the one along comes on top;
        "attitude_error_rms_rad", "attitude_error_max_rad": between desired and actual attitude;
        "speed_mean_m_s": over ground;
        "travelled_m": arc length that the target has run;
        "energy_J": drawn by the thrusters; NaN where the model does not state it;
        "residual_max_N": of the allocation;
        "thrusters_lost": believed dead or stuck at the end.
    """

    def column(name: str) -> NDArray[np.float64]:
        return signals[name][:, 1:]

    if not len(signals["pose.position"]):
        return dict.fromkeys(_STATISTICS, nan)
    cross_track, off = column("path_error.cross_track"), column("path_error.attitude")
    arc_length = column("target.arc_length")
    values = (
        _rms(cross_track),
        cross_track.max(),
        _rms(off),
        off.max(),
        np.linalg.norm(column("velocity.linear"), axis=1).mean(),
        arc_length[-1, 0] - arc_length[0, 0],
        column("power.energy")[-1, 0] if "power.energy" in signals else nan,
        column("allocation.residual").max(),
        np.count_nonzero(column("health.believed")[-1] == 0.0),
    )
    return {name: float(value) for name, value in zip(_STATISTICS, values, strict=True)}


_STATISTICS = (
    "cross_track_rms_m",
    "cross_track_max_m",
    "attitude_error_rms_rad",
    "attitude_error_max_rad",
    "speed_mean_m_s",
    "travelled_m",
    "energy_J",
    "residual_max_N",
    "thrusters_lost",
)


class _StoppedError(Exception):
    """Another flight has failed, or nobody waits for this one any more."""


def _checked(index: int, variation: Mapping[str, Any]) -> dict[str, Any]:
    if not isinstance(variation, Mapping):
        raise ValueError(f"variation {index} is {variation!r}; give a mapping of dotted paths to values")
    return dict(variation)


def _rms(values: NDArray[np.float64]) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _loaded(scenario: AnyScenario, index: int, variation: dict[str, Any], confirm: bool) -> Loaded:
    """One of the scenarios, named where it cannot be flown."""
    try:
        loaded = loaded_with(scenario, variation, None, None, None)
    except ScenarioError as error:
        raise _named(index, error) from None
    allocation = loaded.scenario.allocation
    if confirm or allocation.method != "search+proxqp":
        return loaded
    unconfirmed = allocation.model_copy(update={"method": "search"})
    return replace(loaded, scenario=loaded.scenario.model_copy(update={"allocation": unconfirmed}))


def _outcome(
    index: int, loaded: Loaded, variation: dict[str, Any], wanted: Sequence[str], stop: threading.Event
) -> FlightOutcome:
    """Fly one."""

    def told(_: float) -> None:
        if stop.is_set():
            raise _StoppedError

    try:
        mission = prepared(loaded)
    except ScenarioError as error:
        raise _named(index, error) from None
    known = [f"{channel.name}.{field.name}" for channel in mission.channels for field in channel.fields]
    unknown = [name for name in wanted if name not in known]
    if unknown:
        raise ValueError(f"no signal {unknown[0]!r}; there are {', '.join(known)}")
    scenario, store = mission.scenario, SignalStore(mission.channels)
    flight = Loop(mission, store)
    flight.fly_to_its_end(told)
    recorded = store.signals
    units = units_of(mission.channels)
    results = evaluate(scenario.checks, recorded, duration_s=scenario.duration_s, units=units)
    return FlightOutcome(
        variation=variation,
        verdict=overall(results, complete=not flight.ended),
        checks=results,
        simulated_s=flight.time_s,
        ended_early=flight.ended_early,
        log=store.warnings,
        statistics=statistics_of(recorded),
        signals={name: recorded[name] for name in wanted},
    )


def _named(index: int, error: ScenarioError) -> ScenarioError:
    return ScenarioError([f"variation {index}: {line}" for line in str(error).splitlines()])
