"""What a `samples` block may draw, held against the schema before anything flies."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import Any

from cube_sim.scenario.distribution_blocks import AnyDistribution
from cube_sim.scenario.explain import Refusal
from cube_sim.scenario.fleet import VEHICLES, FleetScenario
from cube_sim.scenario.overrides import apply
from cube_sim.scenario.schema import Scenario
from cube_sim.scenario.varied_values import combined, is_parameter, overrides_of, value_at


def sample_refusals(
    data: dict[str, Any],
    scenario: Scenario | FleetScenario,
    resolved: dict[str, Any],
    refusals_of: Callable[[dict[str, Any]], list[Refusal]],
) -> list[Refusal]:
    """What of the `samples` block gives values that the scenario does not take.

    Each key is tried by itself at the ends of what it gives; all else is as the file has it.

    Args:
        data: the file's, with its overrides.
        scenario: the same, valid.
        resolved: the same as data, with every default.
        refusals_of: what the schema has against data.
    """
    if scenario.samples is None:
        return []
    alone = {key: value for key, value in data.items() if key != "samples"}
    found = []
    for path, distribution in scenario.samples.vary.items():
        found += [
            Refusal(("samples", "vary", path), message, at_key=False)
            for message in _first(_messages(alone, resolved, path, distribution, refusals_of))
        ]
    found += [
        Refusal(("samples", "lost_thrusters", key), f"is after the end at {scenario.duration_s:g} s", at_key=False)
        for key in ("at_s", "until_s")
        if (lost := scenario.samples.lost_thrusters) is not None and (getattr(lost, key) or 0.0) > scenario.duration_s
    ]
    return found


def _first(messages: Iterator[str]) -> list[str]:
    """One is enough for a key."""
    return [message for message in [next(messages, None)] if message is not None]


def _messages(
    data: dict[str, Any],
    resolved: dict[str, Any],
    path: str,
    distribution: AnyDistribution,
    refusals_of: Callable[[dict[str, Any]], list[Refusal]],
) -> Iterator[str]:
    vehicle = path.split(".")[1] if path.startswith(f"{VEHICLES}.") else None
    if vehicle is not None and vehicle not in data.get(VEHICLES, {}):
        yield f"no vehicle '{vehicle}'; there are {', '.join(data.get(VEHICLES, {})) or 'none with names'}"
        return
    for drawn in distribution.ends:
        try:
            nominal = None if distribution.gives == "value" else value_at(resolved, path)
            value = combined(nominal, distribution.gives, drawn)
        except LookupError:
            if not is_parameter(path):  # what the model has, only the model says
                yield f"the scenario has nothing there that a {distribution.gives} could be of"
            continue
        except ValueError as error:
            yield str(error)
            continue
        changed, _, wrong = apply(data, overrides_of(data, resolved, path, value))
        yield from (message.partition(": ")[2] for message in wrong)
        if not wrong:
            yield from (_said(refusal, path, value) for refusal in refusals_of(changed))


def _said(refusal: Refusal, path: str, value: Any) -> str:
    where = ".".join(map(str, refusal.location))
    if refusal.at_key:
        return f"{where}: {refusal.message}"
    inside = "" if where == path else f"{where}: "
    return f"may be {value!r:.60}: {inside}{refusal.message}"
