"""Another vehicle, water and beginning for each flight of an environment."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from cube_sim.errors import FlightError, ModelError
from cube_sim.mission.parameter_values import factors_on, parameter_values
from cube_sim.nearest import among
from cube_sim.scenario import Scenario
from cube_sim.vehicle.mjcf.elements import LAG, is_of_element, lags_of, require_possible
from cube_sim.vehicle.vehicle import Vehicle

GROUPS = ("scenario", "model", "thrusters", "faults")
FAULTS = ("most", "at_s", "states", "efficiency")
STATES = ("dead", "weak", "stuck")


@dataclass(frozen=True)
class UniformRange:
    """Numbers between two ends, each independent of the others.

    Attributes:
        low: (...) the lower ends.
        high: (...) the upper ends.
    """

    low: NDArray[np.float64]
    high: NDArray[np.float64]

    @staticmethod
    def read(name: str, given: Any) -> UniformRange:
        """[low, high], two numbers or two lists of as many.

        Raises:
            FlightError: it is something else.
        """
        try:
            low, high = (np.asarray(end, dtype=np.float64) for end in given)
        except (TypeError, ValueError):
            raise FlightError(f"randomise {name}: takes [lowest, highest], not {given!r:.60}") from None
        if low.shape != high.shape or not np.isfinite([low, high]).all() or np.any(low > high):
            raise FlightError(f"randomise {name}: takes [lowest, highest], finite and in order, not {given!r:.60}")
        return UniformRange(low, high)

    def draw(self, rng: np.random.Generator) -> Any:
        """A number, or a list of them."""
        return rng.uniform(self.low, self.high).tolist() if self.low.shape else float(rng.uniform(self.low, self.high))


@dataclass(frozen=True)
class OneOf:
    """One of some values, each as likely."""

    values: tuple[Any, ...]

    def draw(self, rng: np.random.Generator) -> Any:
        """One of them."""
        return self.values[int(rng.integers(len(self.values)))]


@dataclass(frozen=True)
class Faults:
    """Thrusters that fail on the way.

    Attributes:
        most: how many fail at most; how many do is uniform from 0.
        at_s: when [s].
        states: what becomes of them, each as likely.
        efficiency: of a weak one.
    """

    most: int
    at_s: UniformRange
    states: OneOf
    efficiency: UniformRange

    @staticmethod
    def read(given: Any, scenario: Scenario, vehicle: Vehicle) -> Faults:
        """Of a mapping; what it leaves out is: one thruster, at any time of the flight, dead, at half its force.

        Raises:
            FlightError: it makes no sense.
        """
        group = _mapping("faults", given, FAULTS)
        m, most, states = len(vehicle.thrusters.names), group.get("most", 1), tuple(group.get("states", ("dead",)))
        if type(most) is not int or not 0 <= most <= m:
            raise FlightError(f"randomise faults.most: takes 0 to {m}, the number of thrusters, not {most!r}")
        if not states or any(state not in STATES for state in states):
            raise FlightError(f"randomise faults.states: takes some of {', '.join(STATES)}, not {list(states)!r}")
        at_s = UniformRange.read("faults.at_s", group.get("at_s", (0.0, scenario.duration_s)))
        share = UniformRange.read("faults.efficiency", group.get("efficiency", (0.5, 0.5)))
        for name, each, end in (("at_s", at_s, scenario.duration_s), ("efficiency", share, 1.0)):
            if each.low.shape or each.low < 0.0 or each.high > end:
                raise FlightError(f"randomise faults.{name}: takes [lowest, highest] between 0 and {end:g}")
        return Faults(most, at_s, OneOf(states), share)

    def draw(self, rng: np.random.Generator, vehicle: Vehicle) -> list[dict[str, Any]]:
        """The events of a scenario."""
        count = int(rng.integers(self.most + 1))
        events = []
        for i in rng.choice(len(vehicle.thrusters.names), count, replace=False).tolist():
            event = {"kind": "thrusters", "at_s": self.at_s.draw(rng), "thrusters": [vehicle.thrusters.names[i]]}
            state = self.states.draw(rng)
            if state == "weak":
                event |= _weakened(self.efficiency.draw(rng))
            elif state == "stuck":
                limits = vehicle.thrusters.limits[i]
                event |= {"state": state, "force_N": float(rng.uniform(limits[0], limits[3]))}
            else:
                event["state"] = state
            events.append(event)
        return events


class Randomisation:
    """What of a scenario is drawn anew for each flight, and from where.

    The mapping may have these groups; a range is [lowest, highest], of two numbers or two lists of as many, and each
    number is uniform between its ends.

    - scenario: dotted path -> range, or {"one_of": [...]}: values in place of the scenario's, as for overrides.
    - model: name of a custom numeric of the MJCF, `hull:added_mass` for one, or of what its elements say (`hull:mass`,
      `hull:inertia`, `hull:centre_of_mass`, `hull:thruster_lag`) -> range of a factor on it: one factor for all its
      values where the range has two numbers (of a `thruster_characteristic`: all its forces), else one for each.
    - thrusters: range of the share of its force each thruster gives from the beginning.
    - faults: {"most": number, "at_s": range, "states": some of dead, weak, stuck, "efficiency": range, of a weak one}.

    Args:
        given: the mapping.
        scenario: what it changes.
        model: of that scenario.
        vehicle: likewise.

    Raises:
        FlightError: the mapping makes no sense.
    """

    def __init__(self, given: Mapping[str, Any], scenario: Scenario, model: mujoco.MjModel, vehicle: Vehicle) -> None:
        groups = _mapping("", given, GROUPS)
        self._vehicle = vehicle
        self._events = [event.model_dump() for event in scenario.events]
        self._values = {
            key: _choice(key, value) for key, value in _mapping("scenario", groups.get("scenario", {})).items()
        }
        self._factors = {
            name: (_numbers(name, scenario, model), UniformRange.read(name, value))
            for name, value in _mapping("model", groups.get("model", {})).items()
        }
        for name, (numbers, factor) in self._factors.items():
            if factor.low.shape not in ((), numbers.shape):
                raise FlightError(f"randomise model.{name}: takes 1 factor or {len(numbers)}, not {factor.low.shape}")
            if is_of_element(name):
                _require_possible(name, numbers, factor)
        self._lagging = {
            name: [*lags_of(model, name.rpartition(":")[0])] for name in self._factors if name.endswith(f":{LAG}")
        }
        share = groups.get("thrusters")
        self._share = None if share is None else UniformRange.read("thrusters", share)
        if self._share is not None and (self._share.low.shape or self._share.low < 0.0 or self._share.high > 1.0):
            raise FlightError("randomise thrusters: takes [lowest, highest] between 0 and 1")
        faults = groups.get("faults")
        self._faults = None if faults is None else Faults.read(faults, scenario, vehicle)

    def draw(self, rng: np.random.Generator) -> dict[str, Any]:
        """Overrides of the scenario for one flight; the same generator in the same state gives the same ones."""
        drawn = {key: value.draw(rng) for key, value in self._values.items()}
        for name, (numbers, factor) in self._factors.items():
            values = (numbers * factors_on(name, numbers, factor.draw(rng))).tolist()
            if name in self._lagging:
                drawn |= {
                    f"parameters.{each}:{LAG}": [lag] for each, lag in zip(self._lagging[name], values, strict=True)
                }
            else:
                drawn[f"parameters.{name}"] = values
        events = []
        if self._share is not None:
            for name in self._vehicle.thrusters.names:
                weak = _weakened(self._share.draw(rng))
                events += [{"kind": "thrusters", "at_s": 0.0, "thrusters": [name], **weak}] if weak else []
        if self._faults is not None:
            events += self._faults.draw(rng, self._vehicle)
        if events:
            drawn["events"] = [*drawn.get("events", self._events), *events]
        return drawn


def _mapping(name: str, given: Any, known: tuple[str, ...] | None = None) -> Mapping[str, Any]:
    """What is given, a mapping whose keys are known."""
    where = f"randomise {name}".rstrip()
    if not isinstance(given, Mapping):
        raise FlightError(f"{where}: takes a mapping, not {given!r:.60}")
    if known is not None and (unknown := [key for key in given if key not in known]):
        raise FlightError(f"{where}: no '{unknown[0]}'; there are {among(str(unknown[0]), known)}")
    return given


def _choice(name: str, given: Any) -> UniformRange | OneOf:
    if not isinstance(given, Mapping):
        return UniformRange.read(f"scenario.{name}", given)
    values = tuple(_mapping(f"scenario.{name}", given, ("one_of",)).get("one_of", ()))
    if not values:
        raise FlightError(f"randomise scenario.{name}: one_of takes at least one value")
    return OneOf(values)


def _numbers(name: str, scenario: Scenario, model: mujoco.MjModel) -> NDArray[np.float64]:
    try:
        return parameter_values(name, scenario.parameters, model)
    except ModelError as error:
        raise FlightError(f"randomise model: {error.reason}") from None


def _require_possible(name: str, numbers: NDArray[np.float64], factor: UniformRange) -> None:
    """Refuse a range of which some draw would be refused, and only amid training.

    What may be drawn is a box, and what is possible is convex: its corners are enough.
    """
    ends = zip(*(np.broadcast_to(end, numbers.shape) for end in (factor.low, factor.high)), strict=True)
    corners = [factor.low, factor.high] if not factor.low.shape else product(*({low, high} for low, high in ends))
    for corner in corners:
        values = numbers * np.asarray(corner)
        try:
            for given in values[:, None] if name.endswith(f":{LAG}") else [values]:
                require_possible(name, given)
        except ModelError as error:
            raise FlightError(f"randomise model.{name}: at its ends it {error.reason}") from None


def _weakened(share: float) -> dict[str, Any]:
    """What an event says of a thruster that gives a share of its force; nothing where it gives all."""
    if share >= 1.0:
        return {}
    return {"state": "weak", "efficiency": share} if share > 0.0 else {"state": "dead"}
