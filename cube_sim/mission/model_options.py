"""What a model's file says of time step and current, where its scenario says otherwise."""

from __future__ import annotations

from pathlib import Path
from xml.parsers import expat

from cube_sim.mission.water import water_schedule
from cube_sim.scenario import Scenario
from cube_sim.vehicle.mjcf.places import elements_of


def option_words(scenario: Scenario) -> list[str]:
    """A sentence for each option of the model's file that its owner would miss: a finer step, a current.

    Args:
        scenario: which says both, whatever the file says.
    """
    try:
        options = [place.attributes for place in elements_of(Path(scenario.model)) if place.tag == "option"]
    except (OSError, expat.ExpatError):  # not flown from a file
        return []
    stated = {name: value for each in options for name, value in each.items()}
    steps, wind = _numbers(stated.get("timestep", "")), _numbers(stated.get("wind", ""))
    step, said = scenario.physics.step_s, []
    if steps and steps[0] < step * (1.0 - 1e-9):
        said.append(
            f"its model's file has timestep {steps[0]:g}, and steps of {step:g} s are flown: a scenario says them by "
            "physics.step_s"
        )
    if any(wind) and not any(scenario.current_m_s) and water_schedule(scenario) is None:
        text = " ".join(f"{each:g}" for each in wind)
        said.append(
            f"its model's file has wind {text}, and the water is at rest: a scenario says its current by current_m_s"
        )
    return said


def _numbers(text: str) -> list[float]:
    try:
        return [float(each) for each in text.split()]
    except ValueError:
        return []
