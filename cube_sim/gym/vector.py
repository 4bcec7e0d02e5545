"""Several environments as one."""

from __future__ import annotations

from functools import partial
from typing import Any

from gymnasium.vector import AsyncVectorEnv, SyncVectorEnv, VectorEnv

from cube_sim.errors import FlightError
from cube_sim.gym.flight_env import FlightEnv
from cube_sim.mission.own.given import AnyScenario


def make_vec(scenario: AnyScenario, count: int, *, processes: bool = False, **arguments: Any) -> VectorEnv:
    """Flights of one scenario side by side, each with draws of its own.

    `reset(seed=k)` seeds them with k, k + 1, ...; a flight that is over starts again at the next step.

    Args:
        scenario: as for `FlightEnv`.
        count: how many.
        processes: whether each gets a process of its own. What is given must then be picklable, and a program needs
            its `if __name__ == "__main__":`.
        arguments: as for `FlightEnv`.

    Raises:
        FlightError: the count is not above 0.
    """
    if count < 1:
        raise FlightError(f"count takes a whole number above 0, not {count!r}")
    makers = [partial(FlightEnv, scenario, **arguments)] * count
    return AsyncVectorEnv(makers) if processes else SyncVectorEnv(makers)
