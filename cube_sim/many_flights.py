"""Many flights of one scenario at once, on threads: compiled loops that need no interpreter."""

from __future__ import annotations

import os
import threading
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import FIRST_EXCEPTION, ThreadPoolExecutor, wait
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, replace
from traceback import format_exception
from typing import Any, Protocol

from cube_sim.asked_store import AskedStore
from cube_sim.errors import OwnCodeError, ScenarioError
from cube_sim.flight_statistics import Signals
from cube_sim.mission.channels import fins_fail
from cube_sim.mission.disturbance import force_events
from cube_sim.mission.navigation import channels_of
from cube_sim.mission.own.given import AnyScenario, loaded_with
from cube_sim.mission.setpoints import commanded
from cube_sim.nearest import among
from cube_sim.recording.channels import SUPPLY, channel_table
from cube_sim.run_log import LogLine
from cube_sim.scenario import Loaded
from cube_sim.scenario.fleet_loading import AnyLoaded, LoadedFleet
from cube_sim.scenario.phase_blocks import is_timed
from cube_sim.scenario.python_block import python_blocks
from cube_sim.scenario.shared import Shared
from cube_sim.undertaking import undertaking
from cube_sim.vehicle.plugin.hook import install
from cube_sim.verdict import CheckResult, EarlyEnd, Verdict, overall


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
        traceback: of an exception of the user's own code that ended it; "" of none.
        signals: those asked for that it records, "channel.field" -> (n, 1 + width), column 0 the time [s].
    """

    variation: Mapping[str, Any]
    verdict: Verdict
    checks: tuple[CheckResult, ...]
    simulated_s: float
    ended_early: EarlyEnd | None
    log: tuple[LogLine, ...]
    statistics: Mapping[str, float]
    signals: Signals
    traceback: str = ""


def fly_many(
    scenario: AnyScenario,
    variations: Iterable[Mapping[str, Any]],
    *,
    threads: int | None = None,
    signals: Sequence[str] = (),
    confirm: bool = False,
) -> list[FlightOutcome]:
    """Fly a scenario once for each variation of it, to the bit as each would be flown alone.

    Nothing is written, and but for the signals asked for no rows are kept. Loops that compiled code flies run beside
    each other. What takes Python now and then (thruster faults at the moment they are found) waits for its turn.
    Flights with code of the user's own in them take Python at every tick: on threads they would only be in each other's
    way, so they are flown one at a time, beside the others.

    Args:
        scenario: a file, what would stand in one, or a loaded one.
        variations: dotted path -> value in place of the scenario's, one mapping for each flight, e.g.
            ``[{"seed": k} for k in range(1000)]``.
        threads: how many flights at a time, own code or not; unless told, as many as there are processors, those with
            own code one at a time.
        signals: names of the signals to keep, e.g. ``["pose.position"]``. A flight that does not record one, as one
            without a battery has no voltage, says so in its log.
        confirm: whether ProxQP confirms every answer of the search where the scenario says so. It changes no bit of
            a flight, and takes Python at every tick.

    Returns:
        One outcome for each variation, in their order.

    Raises:
        ScenarioError: a variation cannot be flown; which one it is stands first. None is flown then whose mistake
            shows in the scenario itself.
        ValueError: threads below 1, or a signal that no variation records; nothing is flown then.
    """
    if threads is not None and threads < 1:
        raise ValueError(f"threads is {threads}; at least one flies")
    if isinstance(signals, str):
        raise ValueError(f"signals takes a list of names, not {signals!r}")
    varied, shared = [_checked(index, variation) for index, variation in enumerate(variations)], Shared()
    loaded = [
        replace(_loaded(scenario, index, variation, confirm), shared=shared) for index, variation in enumerate(varied)
    ]
    _require_possible(signals, loaded)
    install()
    stop = threading.Event()
    with ThreadPoolExecutor(threads or os.cpu_count() or 1) as pool, ThreadPoolExecutor(1) as turn:
        asked = [
            (turn if threads is None and flies_in_python(one) else pool).submit(
                _outcome, index, one, variation, signals, stop
            )
            for index, (one, variation) in enumerate(zip(loaded, varied, strict=True))
        ]
        try:
            wait(asked, return_when=FIRST_EXCEPTION)
            for each in asked:
                if each.done() and (failure := each.exception()) is not None:
                    raise failure
            return [each.result() for each in asked]
        finally:
            stop.set()  # whoever is in the air when one fails, or on Ctrl-C, lands within a simulated second or ten
            for each_pool in (pool, turn):
                each_pool.shutdown(wait=False, cancel_futures=True)


class Stop(Protocol):
    """Says whether a flight is to be left, as a threading.Event does."""

    def is_set(self) -> bool:
        """Whether it is."""
        ...


class StoppedFlightError(Exception):
    """Another flight has failed, or nobody waits for this one any more."""


def _checked(index: int, variation: Mapping[str, Any]) -> dict[str, Any]:
    if not isinstance(variation, Mapping):
        raise ValueError(f"variation {index} is {variation!r}; give a mapping of dotted paths to values")
    return dict(variation)


def _loaded(scenario: AnyScenario, index: int, variation: dict[str, Any], confirm: bool) -> Loaded:
    """One of the scenarios, named where it cannot be flown."""
    try:
        loaded = loaded_with(scenario, variation, None, None, None)
    except ScenarioError as error:
        raise _named(index, error) from None
    return loaded if confirm else _unconfirmed(loaded)


def _outcome(
    index: int, loaded: Loaded, variation: dict[str, Any], wanted: Sequence[str], stop: threading.Event
) -> FlightOutcome:
    """Fly one."""
    try:
        return flown(loaded, variation, wanted, stop)
    except ScenarioError as error:
        raise _named(index, error) from None


def flown(
    loaded: AnyLoaded,
    variation: Mapping[str, Any],
    wanted: Sequence[str] = (),
    stop: Stop | None = None,
    around: AbstractContextManager[Any] | None = None,
) -> FlightOutcome:
    """Fly one scenario of many, and judge it; nothing is written.

    Args:
        loaded: the scenario.
        variation: what of it was varied, for the outcome to say.
        wanted: names of the signals to keep.
        stop: once it is set, the flight lands within a simulated second or ten.
        around: entered for the flight itself, its last row judged, without its preparation.

    Raises:
        ScenarioError: it cannot be flown.
        StoppedFlightError: it was stopped.
    """

    def told(_: float) -> None:
        if stop is not None and stop.is_set():
            raise StoppedFlightError

    mission = undertaking(loaded)
    known = [f"{channel.name}.{field.name}" for channel in mission.channels for field in channel.fields]
    judge = mission.judge()
    store = AskedStore(mission.channels, judge, [name for name in wanted if name in known])
    flight = mission.loop(store)
    if missing := [name for name in wanted if name not in known]:
        store.log(0.0, "WARNING", f"this flight does not record {', '.join(missing)}")
    with around or nullcontext():
        flight.fly_to_its_end(told)
        store.settle()
    early = flight.ended_early
    proper = early is None or early.verdict != "ERROR"
    results = judge.results(mission.scenario.duration_s if early is None or not proper else early.time_s)
    return FlightOutcome(
        variation=variation,
        verdict=overall(results, complete=proper, failed=early is not None and early.verdict == "FAIL"),
        checks=results,
        simulated_s=flight.time_s,
        ended_early=early,
        log=store.warnings,
        statistics={} if mission.among else store.statistics.results(),
        signals=store.signals,
        traceback=own_traceback(flight.raised),
    )


def own_traceback(raised: BaseException | None) -> str:
    """Of the exception in the user's own code that an error comes of, from the first line of that code on; or ""."""
    while raised is not None and not isinstance(raised, OwnCodeError):
        raised = raised.__cause__
    cause = None if raised is None else raised.__cause__
    if cause is None:
        return ""
    place = cause.__traceback__
    return "".join(format_exception(type(cause), cause, None if place is None else place.tb_next))


def unconfirmed(loaded: AnyLoaded) -> AnyLoaded:
    """The same flight without ProxQP's confirmation of every answer, which changes no bit and takes Python's time."""
    if isinstance(loaded, LoadedFleet):
        each = {name: _unconfirmed(one) for name, one in loaded.vehicles.items()}
        scenarios = {name: one.scenario for name, one in each.items()}
        return replace(loaded, vehicles=each, scenario=replace(loaded.scenario, vehicles=scenarios))
    return _unconfirmed(loaded)


def _unconfirmed(loaded: Loaded) -> Loaded:
    allocation = loaded.scenario.allocation
    if allocation.method != "search+proxqp":
        return loaded
    bare = allocation.model_copy(update={"method": "search"})
    return replace(loaded, scenario=loaded.scenario.model_copy(update={"allocation": bare}))


def _require_possible(wanted: Sequence[str], loaded: Sequence[Loaded]) -> None:
    """Refuse a signal that none of the scenarios records, whatever its vehicle.

    Raises:
        ValueError: with the names there are.
    """
    pushed = any(force_events(one.scenario) for one in loaded)
    phased = ("1",) * any(one.scenario.phases for one in loaded)
    timed = any(is_timed(one.scenario.phases) for one in loaded)
    told = tuple(dict.fromkeys(name for one in loaded for name in commanded(one.scenario)))
    joints = (("J1", "1"),), (("J1", "1"),)
    others = told, (("1", "1"),) * len(told), ("F1",) * any(fins_fail(one.scenario) for one in loaded), *joints
    channels = channel_table(("T1",), 1, (), (), SUPPLY, pushed, phased, timed, ("F1",), *others)
    known = dict.fromkeys(f"{channel.name}.{field.name}" for channel in channels for field in channel.fields)
    for one in loaded:
        sensed = channels_of(one.scenario.navigation)
        known |= dict.fromkeys(f"{channel.name}.{field.name}" for channel in sensed for field in channel.fields)
    unknown = [name for name in wanted if name not in known]
    if unknown and loaded:
        raise ValueError(f"no signal {unknown[0]!r}; there are {among(unknown[0], known)}")


def flies_in_python(loaded: Loaded) -> bool:
    """Whether there is code of the user's own in a scenario."""
    return any(True for _ in python_blocks(loaded.scenario))


def _named(index: int, error: ScenarioError) -> ScenarioError:
    return ScenarioError([f"variation {index}: {line}" for line in str(error).splitlines()])
