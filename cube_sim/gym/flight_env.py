"""A scenario as an environment of Gymnasium."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import gymnasium
import numpy as np
from gymnasium.spaces import Box

from cube_sim.errors import FlightError
from cube_sim.flight import Flight, Observation
from cube_sim.gym.actions import ActionScale
from cube_sim.gym.layout import ObservationLayout
from cube_sim.gym.randomisation import Randomisation
from cube_sim.gym.reward import FollowingReward, Reward, Stepped
from cube_sim.mission.own.given import AnyScenario, loaded_with
from cube_sim.scenario import Loaded
from cube_sim.scenario.loading import loaded_again
from cube_sim.scenario.shared import Shared
from cube_sim.spatial import Vector


class FlightEnv(gymnasium.Env[Vector, Vector]):
    """A vehicle in its water, flown by an agent; docs/stepping.md has an example.

    An action is numbers between -1 and 1, see `ActionScale`; an observation is one vector, see `ObservationLayout`. A
    flight is terminated when it ends early, when the controller gives the path up, or too far from the target; it is
    truncated at the end of its time. `info` has

    - observation: the `Observation` of the flight;
    - ended: why it is terminated, "" while it is not;
    - seed (of a reset): that of the flight's random streams.

    Attributes:
        flight: the flight; its `signals` are what was recorded since the reset.
        layout: where what stands in an observation.
        scale: what an action stands for.
    """

    def __init__(
        self,
        scenario: AnyScenario,
        overrides: Mapping[str, Any] | None = None,
        *,
        action: str = "wrench",
        ticks: int = 1,
        randomise: Mapping[str, Any] | None = None,
        reward: Reward | None = None,
        ahead_m: Sequence[float] = (0.0, 0.5, 1.0, 2.0),
        too_far_m: float = 10.0,
        render_mode: None = None,
    ) -> None:
        """Prepare an environment.

        Args:
            scenario: a file, what would stand in one, or a loaded one.
            overrides: dotted path -> value in place of the scenario's.
            action: wrench, forces or commands.
            ticks: control periods to a step, over which an action is held.
            randomise: what is drawn anew at each reset, see `Randomisation`.
            reward: what a step is worth; by default a `FollowingReward`.
            ahead_m: distances ahead of the target at which the agent sees the path [m].
            too_far_m: distance from the target, beyond that at the beginning, at which a flight is terminated [m].
            render_mode: there is none.

        Raises:
            ScenarioError: the scenario cannot be flown; one line per mistake.
            FlightError: another argument makes no sense.
        """
        if type(ticks) is not int or ticks < 1:
            raise FlightError(f"ticks takes a whole number above 0, not {ticks!r}")
        # What resets have in common is made once: the model is compiled, and copies get what is drawn.
        self._loaded = self._flown = replace(loaded_with(scenario, overrides), shared=Shared())
        self.flight = Flight(self._loaded)
        mission = self.flight.mission
        self._randomisation: Randomisation | None = None
        if randomise is not None:
            self._randomisation = Randomisation(randomise, mission.scenario, mission.model, mission.vehicle)
            # What the scenario cannot take is said here, not at the first reset.
            loaded_again(self._loaded, self._randomisation.draw(np.random.default_rng(0)))
        self._ticks, self._too_far, self._seed = ticks, too_far_m, mission.scenario.seed
        self._reward: Reward = FollowingReward() if reward is None else reward
        self._speed = mission.scenario.guidance.speed_m_s if mission.path.length > 0.0 else 0.0
        self.scale = ActionScale.of(action, mission.vehicle)
        wrench, forces = (ActionScale.of(kind, mission.vehicle) for kind in ("wrench", "forces"))
        self.layout = ObservationLayout.of(wrench, forces, ahead_m)
        self.render_mode = render_mode
        self.action_space = Box(-1.0, 1.0, self.scale.low.shape, np.float64)
        self.observation_space = Box(-self.layout.bounds, self.layout.bounds, dtype=np.float64)
        self._seen = self.flight.observation()
        self._limit = self._distance + too_far_m

    @property
    def loaded(self) -> Loaded:
        """What is flown since the last reset, its seed included: `cube_sim.fly(env.loaded)` flies it by our own law."""
        return loaded_again(self._flown, {"seed": self._seed})

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Vector, dict[str, Any]]:
        """To the beginning of another flight; see `gymnasium.Env.reset`.

        Args:
            seed: of the environment's generator, from which everything is drawn; None: it goes on.
            options: {"state": State}: of the vehicle in place of the scenario's initial one.

        Raises:
            ScenarioError: what was drawn cannot be flown.
            FlightError: the options make no sense.
        """
        super().reset(seed=seed)
        given = dict(options or {})
        state = given.pop("state", None)
        if given:
            raise FlightError(f"no option '{next(iter(given))}'; there is state")
        if self._randomisation is not None:
            self._flown = loaded_again(self._loaded, self._randomisation.draw(self.np_random))
            self.flight = Flight(self._flown)
        self._seed = int(self.np_random.integers(2**63))
        self._seen = self.flight.reset(self._seed, state)
        self._limit = self._distance + self._too_far
        return self._vector(), {"observation": self._seen, "ended": "", "seed": self._seed}

    def step(self, action: Vector) -> tuple[Vector, float, bool, bool, dict[str, Any]]:
        """Fly on under an action; see `gymnasium.Env.step`.

        Args:
            action: (n,) between -1 and 1.

        Raises:
            FlightError: the action is of another shape or not finite, or the flight is over.
        """
        before, asked, ticks = self._seen, {self.scale.kind: self.scale.asked(action)}, 0
        while ticks < self._ticks and not self.flight.over:
            self._seen, ticks = self.flight.step(**asked), ticks + 1
        if ticks == 0:
            raise FlightError("the flight is over; reset the environment")
        seen, period = self._seen, self.flight.mission.scenario.control_period_s
        effort = float(np.mean(self.layout.forces.share(seen.force) ** 2))
        reward = self._reward(Stepped(before, seen, np.asarray(action), effort, self._speed, ticks * period))
        ended = self._ended(seen)
        info = {"observation": seen, "ended": ended}
        return self._vector(), float(reward), bool(ended), seen.over and not ended, info

    def _vector(self) -> Vector:
        return self.layout.vector(self._seen, self.flight.mission.path)

    @property
    def _distance(self) -> float:
        """From the target [m]."""
        return float(np.linalg.norm(self._seen.view.error))

    def _ended(self, seen: Observation) -> str:
        """Why a flight is terminated."""
        if seen.ended or seen.given_up:
            return seen.ended or f"the path is given up: {seen.given_up}"
        return "" if self._distance <= self._limit else f"more than {self._limit:.3g} m from the target"
