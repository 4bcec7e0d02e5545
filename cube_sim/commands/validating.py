"""A scenario looked at whole without flying it: its file, its model, its path, events, checks and samples."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cube_sim.errors import CubeSimError, ScenarioError

if TYPE_CHECKING:
    from cube_sim.scenario.fleet_loading import AnyLoaded


def validated(file: Path, overrides: Mapping[str, Any] | None = None) -> AnyLoaded:
    """A scenario of which everything is known to be right that can be known before the flight.

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

            prepare_fleet(loaded)
            return loaded
        prepare(loaded)
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
