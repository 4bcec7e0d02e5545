"""What a mission is warned of before it flies."""

from __future__ import annotations

from math import inf

from cube_sim.mission import Mission
from cube_sim.mission.ceiling import ceiling_words
from cube_sim.mission.knowledge import unlikely_factor_words
from cube_sim.mission.model_options import option_words
from cube_sim.mission.slow_pumps import slow_pump_words
from cube_sim.mission.surface_watch import path_above_surface, top_over_origin
from cube_sim.mission.tight_turns import tight_turn_words
from cube_sim.mission.way_of_flying import cannot_follow, steered_at_speed_only
from cube_sim.vehicle.floating import water_surface
from cube_sim.vehicle.remarks import cautions


def first_warnings(mission: Mission) -> list[str]:
    """A sentence for each thing that is most likely a mistake: of vehicle, water, knowledge, pumps, path and speed."""
    surface, near = water_surface(mission.model), None
    if surface < inf:
        near = path_above_surface(mission.outline, surface, top_over_origin(mission.model, mission.vehicle))
    if near is not None and (lifted := ceiling_words(mission)):
        near = f"{near}; {lifted}"
    follows = cannot_follow(mission.ability, mission.outline)
    still = None if mission.path.length > 0.0 else steered_at_speed_only(mission.ability)
    fast = mission.too_fast(mission.ability.within_limit)
    tight = None if follows else tight_turn_words(mission)
    return [
        *cautions(mission.model, mission.vehicle),
        *option_words(mission.scenario),
        *unlikely_factor_words(mission.scenario.knowledge),
        *slow_pump_words(mission.setpoints, mission.vehicle.ballast, mission.scenario.duration_s),
        *(each for each in (near, follows, tight, still, fast) if each is not None),
    ]
