"""What sample k of a scenario flies: every value a function of the seed, of k and of the key, and of nothing else.

Each varied key has a stream of its own, SeedSequence(seed, spawn_key=(k, crc32(path))): another key more or less, or
another count, leaves its values as they are. Grids, Sobol points and combinations are gone through by k.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any
from zlib import crc32

import numpy as np
from scipy.stats import qmc

from cube_sim.campaign.drawing import drawn, one_or_list
from cube_sim.campaign.lost_combinations import combination, combination_count, event_of
from cube_sim.campaign.possible_setpoints import SetpointPath, never_followed, setpoint_path
from cube_sim.errors import ModelError, ScenarioError
from cube_sim.mission.hull import CompiledHull, flown_hull
from cube_sim.mission.own.code import OwnCode, own_code, refused, require_taken
from cube_sim.mission.parameter_values import factors_on, parameter_values
from cube_sim.nearest import among
from cube_sim.scenario import Loaded
from cube_sim.scenario.distribution_blocks import AnyDistribution, ChoiceBlock, GridBlock, SobolBlock
from cube_sim.scenario.fleet import FleetScenario
from cube_sim.scenario.fleet_loading import AnyLoaded, LoadedFleet, any_again
from cube_sim.scenario.overrides import apply
from cube_sim.scenario.python_block import PythonBlock
from cube_sim.scenario.samples_block import LOST_THRUSTERS, SamplesBlock
from cube_sim.scenario.varied_values import ParameterPath, combined, overrides_of, parameter_at, value_at
from cube_sim.vehicle.loading import load_model
from cube_sim.vehicle.mjcf.elements import LAG, lags_of

_SOBOL, _GENERATOR, _MOMENT, _SEED = "sobol", "generator", f"{LOST_THRUSTERS}.at_s", "seed"


@dataclass(frozen=True)
class DrawnSample:
    """One sample.

    Attributes:
        index: k, from 0.
        values: what was drawn: dotted path -> value, factor, change in percent or offset, as the block says;
            ``lost_thrusters`` -> their names; what a generator of the user's own gave that gave no notes.
        overrides: what that makes of the scenario: dotted path -> value.
        notes: what a generator of the user's own says of it, by name.
    """

    index: int
    values: Mapping[str, Any]
    overrides: Mapping[str, Any]
    notes: Mapping[str, Any] = field(default_factory=dict)


def count(loaded: AnyLoaded) -> int:
    """How many samples a scenario has; 0 where it has no `samples` block.

    Raises:
        ScenarioError: the vehicle, whose thrusters are combined, cannot be loaded.
    """
    return 0 if loaded.scenario.samples is None else SamplePlan(loaded).count


def sample(loaded: AnyLoaded, k: int) -> AnyLoaded:
    """The scenario that sample k flies: its values in place, and no samples of its own.

    Raises:
        ScenarioError: there is no such sample, or its scenario is none that can be flown.
    """
    plan = SamplePlan(loaded)
    return plan.scenario_of(plan.sample(k))


def variation(loaded: AnyLoaded, k: int) -> dict[str, Any]:
    """What was drawn for sample k, see `DrawnSample.values`.

    Raises:
        ScenarioError: there is no such sample.
    """
    return dict(SamplePlan(loaded).sample(k).values)


class SamplePlan:
    """All samples of a scenario.

    Args:
        loaded: the scenario, with a `samples` block.

    Raises:
        ScenarioError: it has none, or code that it names cannot be found.
    """

    def __init__(self, loaded: AnyLoaded) -> None:
        block = loaded.scenario.samples
        if block is None:
            raise ScenarioError([loaded.mistake("", "has no samples: block, so there is no sample of it")])
        if lost := [said for each in loaded.overrides if (said := _lost(each.path, block))]:
            raise ScenarioError(lost)
        self._loaded, self._block = loaded, block
        self._written = apply(loaded.document.data, {each.path: each.value for each in loaded.overrides})[0]
        whole = loaded.scenario
        self._resolved: dict[str, Any] = whole.as_data() if isinstance(whole, FleetScenario) else whole.model_dump()
        evenly = sorted(path for path, each in block.vary.items() if isinstance(each, SobolBlock))
        widths = [len(each.low) for path in evenly if isinstance(each := block.vary[path], SobolBlock)]
        ends = np.cumsum(widths, dtype=int).tolist()
        self._places = {path: slice(end - n, end) for path, end, n in zip(evenly, ends, widths, strict=True)}
        self._hulls: dict[str, CompiledHull] = {}
        self._sobol = _SobolPoints(sum(widths), block.seed)
        self._anchor = loaded.whole if isinstance(loaded, LoadedFleet) else loaded
        self._code = None if block.generator is None else _generator(self._anchor, block)

    @property
    def block(self) -> SamplesBlock:
        """What the scenario says of them."""
        return self._block

    @cached_property
    def count(self) -> int:
        """How many there are."""
        return self._block.count or int(np.prod([size for _, size in self._turns], dtype=object))

    @cached_property
    def thrusters(self) -> tuple[str, ...]:
        """Names of those that may be lost; none where none are."""
        lost = self._block.lost_thrusters
        if lost is None:
            return ()
        names = self._hull("").vehicle.thrusters.names
        for index, name in enumerate(lost.thrusters or ()):
            if name not in names:
                text = f"no thruster '{name}'; the model has {among(name, names)}"
                raise ScenarioError([self._loaded.mistake(f"samples.lost_thrusters.thrusters.{index}", text)])
        possible = lost.thrusters or names
        if max(lost.losses) > len(possible):
            text = f"must be at most {len(possible)}, the number of thrusters"
            raise ScenarioError([self._loaded.mistake("samples.lost_thrusters.losses", text)])
        return tuple(possible)

    def sample(self, k: int) -> DrawnSample:
        """What was drawn for sample k, and what that makes of the scenario.

        Raises:
            ScenarioError: there is no such sample, or code of the user's own gives none.
        """
        if not 0 <= k < self.count:
            raise ScenarioError([self._loaded.mistake("samples", f"no sample {k}: there are 0 to {self.count - 1}")])
        overrides, notes = self._generated(k)
        values = {} if notes else dict(overrides)
        turns = self._turns_of(k)
        for path, distribution in self._block.vary.items():
            number = self._drawn(k, path, distribution, turns)
            values[path] = number
            overrides |= self._overrides_of(path, distribution, number)
        if self._block.lost_thrusters is not None:
            names, at_s = self._lost(k, turns)
            values[LOST_THRUSTERS] = list(names)
            if self._block.lost_thrusters.until_s is not None:
                values[_MOMENT] = at_s
            if names:
                before = overrides.get("events", self._resolved["events"])
                overrides["events"] = [*before, event_of(names, at_s)]
        if self._block.vary_seed and _SEED not in overrides:
            overrides[_SEED] = int(self._rng(k, _SEED).integers(2**63))
        return DrawnSample(k, values, overrides, notes)

    def scenario_of(self, sample: DrawnSample) -> AnyLoaded:
        """The scenario of a sample, without samples of its own.

        Raises:
            ScenarioError: its values are none that can be flown.
        """
        # A value inside the block that goes would bring a part of it back.
        others = tuple(each for each in self._loaded.overrides if each.location[0] != "samples")
        try:
            return any_again(replace(self._loaded, overrides=others), {**sample.overrides, "samples": None})
        except ScenarioError as error:
            raise ScenarioError([f"{line} (sample {sample.index})" for line in error.mistakes]) from None

    def require_possible(self) -> None:
        """Refuse what only the vehicle can tell: names of thrusters, parameters of the model at their ends, set-points.

        Raises:
            ScenarioError: with positions.
        """
        mistakes = []
        self.count  # noqa: B018 - it looks for the thrusters
        for path, distribution in self._block.vary.items():
            if (parameter := parameter_at(path)) is not None:
                mistakes += self._refused_parameter(path, parameter, distribution)
            elif (at := setpoint_path(path)) is not None:
                mistakes += self._refused_setpoint(path, at, distribution)
        if mistakes:
            raise ScenarioError(mistakes)

    def _refused_parameter(self, path: str, parameter: ParameterPath, distribution: AnyDistribution) -> list[str]:
        """One mistake is enough."""
        scenario = self._of(parameter.vehicle).scenario
        for end in distribution.ends:
            try:
                changed = self._overrides_of(path, distribution, end)
                given = {at.name: values for key, values in changed.items() if (at := parameter_at(key)) is not None}
                load_model(scenario.model, {**scenario.parameters, **given})
            except ModelError as error:
                message = f"may be {end!r:.60}: {error}"
                return [self._loaded.mistake(("samples", "vary", path), message)]
            except ScenarioError as error:
                return error.mistakes
        return []

    def _refused_setpoint(self, path: str, at: SetpointPath, distribution: AnyDistribution) -> list[str]:
        values = [self._overrides_of(path, distribution, end)[path] for end in distribution.ends]
        listed = isinstance(distribution, ChoiceBlock) or (isinstance(distribution, GridBlock) and distribution.values)
        scenario, hull = self._of(at.vehicle).scenario, self._hull(at.vehicle)
        said = never_followed(scenario, hull, at.key, values, between=not listed)
        return [self._loaded.mistake(("samples", "vary", path), said)] if said else []

    def _of(self, vehicle: str) -> Loaded:
        """The scenario of a vehicle; "" for the one that there is, or for all of them."""
        if isinstance(self._loaded, LoadedFleet):
            return self._loaded.vehicles.get(vehicle, self._anchor)
        return self._loaded

    def _hull(self, vehicle: str) -> CompiledHull:
        if vehicle not in self._hulls:
            self._hulls[vehicle] = flown_hull(self._of(vehicle))
        return self._hulls[vehicle]

    @cached_property
    def _turns(self) -> list[tuple[str, int]]:
        """What is gone through, and how many values it has, in the order of the names."""
        turns = [(path, each.size) for path, each in self._block.vary.items() if isinstance(each, GridBlock)]
        lost = self._block.lost_thrusters
        if lost is not None and lost.choose == "all":
            turns.append((LOST_THRUSTERS, combination_count(self.thrusters, lost.losses)))
        return sorted(turns)

    def _turns_of(self, k: int) -> dict[str, int]:
        """Which value of each of them sample k has: the digits of k, the last name's changing first."""
        found = {}
        for name, size in reversed(self._turns):
            k, found[name] = divmod(k, size)
        return found

    def _drawn(self, k: int, path: str, distribution: AnyDistribution, turns: Mapping[str, int]) -> Any:
        match distribution:
            case GridBlock():
                return distribution.value(turns[path])
            case SobolBlock():
                share = self._sobol.point(k)[self._places[path]]
                low, high = np.array(distribution.low), np.array(distribution.high)
                return one_or_list(low + (high - low) * share)
        return drawn(distribution, self._rng(k, path))

    def _overrides_of(self, path: str, distribution: AnyDistribution, number: Any) -> dict[str, Any]:
        """What a number drawn makes of the scenario."""
        try:
            if distribution.gives == "value":
                return overrides_of(self._written, self._resolved, path, number)
            if (parameter := parameter_at(path)) is not None:
                return self._changed_parameter(parameter, distribution, number)
            value = combined(value_at(self._resolved, path), distribution.gives, number)
        except (ModelError, ValueError) as error:
            text = error.reason if isinstance(error, ModelError) else str(error)
            raise ScenarioError([self._loaded.mistake(("samples", "vary", path), text)]) from None
        return overrides_of(self._written, self._resolved, path, value)

    def _changed_parameter(self, at: ParameterPath, distribution: AnyDistribution, number: Any) -> dict[str, Any]:
        model, name = self._hull(at.vehicle).model, at.name
        numbers = self._nominal(at)
        if distribution.gives in ("factor", "percent") and np.ndim(number) == 0:
            factor = number if distribution.gives == "factor" else 1.0 + number / 100.0
            values = (numbers * factors_on(name, numbers, factor)).tolist()
        else:
            values = combined(numbers.tolist(), distribution.gives, number)
        if not name.endswith(f":{LAG}"):
            return {at.beside(name): values}
        each = lags_of(model, name.rpartition(":")[0])
        return {at.beside(f"{thruster}:{LAG}"): [lag] for thruster, lag in zip(each, values, strict=True)}

    def _nominal(self, at: ParameterPath) -> np.ndarray:
        given = self._of(at.vehicle).scenario.parameters
        return parameter_values(at.name, {} if at.name.endswith(f":{LAG}") else given, self._hull(at.vehicle).model)

    def _lost(self, k: int, turns: Mapping[str, int]) -> tuple[tuple[str, ...], float]:
        """The thrusters that die, and when [s]."""
        lost = self._block.lost_thrusters
        if lost is None:
            raise ValueError("no thrusters are lost")
        if lost.choose == "all":
            index = turns[LOST_THRUSTERS]
        else:
            index = int(self._rng(k, LOST_THRUSTERS).integers(combination_count(self.thrusters, lost.losses)))
        at_s = lost.at_s if lost.until_s is None else float(self._rng(k, _MOMENT).uniform(lost.at_s, lost.until_s))
        return combination(self.thrusters, lost.losses, index), at_s

    def _generated(self, k: int) -> tuple[dict[str, Any], dict[str, Any]]:
        """What the user's own code gives: overrides, and notes.

        Raises:
            ScenarioError: it raises, or gives something else than a mapping of paths; with position.
        """
        code = self._code
        if code is None:
            return {}, {}
        with refused(self._anchor):
            answer = code.call(code.make, k, self._rng(k, _GENERATOR), **code.options)
            given, notes = answer if isinstance(answer, tuple) and len(answer) == 2 else (answer, {})
            if not _is_by_name(given) or not _is_by_name(notes):
                right = "a mapping of dotted paths to values is right, or a pair: that, and one of names to notes"
                raise code.refuse(f"gives {answer!r:.60}; {right}")
            if any(path.partition(".")[0] == "samples" for path in given):
                raise code.refuse("gives samples; it gives what one of them flies")
        return dict(given), dict(notes)

    def _rng(self, k: int, name: str) -> np.random.Generator:
        """The stream of a key in a sample."""
        seeds = np.random.SeedSequence(self._block.seed, spawn_key=(k, crc32(name.encode())))
        return np.random.default_rng(seeds)


def _lost(path: str, block: SamplesBlock) -> str:
    """Why a value that is set is one that no sample has; "" where it is not."""
    for varied, distribution in block.vary.items():
        if distribution.gives == "value" and f"{path}.".startswith(f"{varied}."):
            return f"override {path}: samples.vary draws {varied}: the value would be that of no sample"
    return ""


def _is_by_name(answer: Any) -> bool:
    return isinstance(answer, Mapping) and all(isinstance(name, str) for name in answer)


def _generator(loaded: Loaded, block: SamplesBlock) -> OwnCode:
    """The user's own code that gives samples.

    Raises:
        ScenarioError: it is not there, or takes other arguments; with position.
    """
    named = block.generator
    if named is None:
        raise ValueError("no code is named")
    code = own_code(loaded, "samples.generator", PythonBlock.model_construct(**dict(named)))
    require_taken(loaded, code, 2)
    return code


class _SobolPoints:
    """Points of a scrambled Sobol sequence, each by its number; one after the other costs least."""

    def __init__(self, dimensions: int, seed: int) -> None:
        self._dimensions, self._seed = dimensions, seed
        self._next = 0
        self._last: np.ndarray = np.empty(0)
        self._sequence: qmc.Sobol | None = None

    def point(self, k: int) -> np.ndarray:
        """Point k (d,), each entry in [0, 1)."""
        if self._sequence is None or k < self._next - 1:
            seeds = np.random.SeedSequence(self._seed, spawn_key=(crc32(_SOBOL.encode()),))
            self._sequence = qmc.Sobol(self._dimensions, scramble=True, rng=np.random.default_rng(seeds))
            self._next = 0
        if k >= self._next:
            if k > self._next:
                self._sequence.fast_forward(k - self._next)
            self._last = self._sequence.random(1)[0]
            self._next = k + 1
        return self._last
