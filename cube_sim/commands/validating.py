"""A scenario looked at whole without flying it: its file, its model, its path, events, checks and samples."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cube_sim.errors import CubeSimError, ScenarioError

if TYPE_CHECKING:
    from cube_sim.mission import Mission
    from cube_sim.scenario.fleet_loading import AnyLoaded


def validated(file: Path, overrides: Mapping[str, Any] | None = None, warned: list[str] | None = None) -> AnyLoaded:
    """A scenario of which everything is known to be right that can be known before the flight.

    Args:
        file: of the scenario.
        overrides: dotted path -> value in place of the scenario's.
        warned: gets what its log will warn of at the beginning, if anybody asks.

    Raises:
        ScenarioError: with a line per mistake, each of which begins with the file or with an override.
    """
    from cube_sim.scenario.fleet_loading import LoadedFleet, load_any

    try:
        loaded = load_any(file, overrides)
        # A file that is wrong says so before MuJoCo is even loaded.
        from cube_sim.mission import prepare

        if isinstance(loaded, LoadedFleet):
            from cube_sim.mission.fleet import prepare_fleet

            for name, mission in prepare_fleet(loaded).missions.items():
                _ask(mission, f"{name}: ", warned)
            return loaded
        _ask(prepare(loaded), "", warned)
        if loaded.scenario.samples is not None:
            from cube_sim.campaign.sampling import SamplePlan

            SamplePlan(loaded).require_possible()
    except ScenarioError:
        raise
    except CubeSimError as error:
        raise ScenarioError([f"{file}: {line}" for line in str(error).splitlines()]) from error
    return loaded


def remarks_on(loaded: AnyLoaded) -> list[str]:
    """What is no mistake, and yet worth knowing before the flight: a line each, with its place."""
    samples = loaded.scenario.samples
    if samples is None or samples.required is None or samples.required.pass_rate is None:
        return []
    from cube_sim.campaign.pass_rate import least_count
    from cube_sim.campaign.sampling import count

    rate, confidence = samples.required.pass_rate, samples.required.confidence
    given, least = count(loaded), least_count(rate, confidence)
    if given >= least:
        return []
    few = f"{given} samples cannot show {rate:g} at {confidence:g} confidence, even if all pass; {least} can"
    return [loaded.mistake("samples.required.pass_rate", few)]


def _ask(mission: Mission, whose: str, warned: list[str] | None) -> None:
    if warned is not None:
        from cube_sim.mission.first_warnings import first_warnings

        warned += [f"{whose}{text}" for text in first_warnings(mission)]
