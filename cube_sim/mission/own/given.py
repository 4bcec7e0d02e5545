"""A scenario together with functions, classes and objects that a program hands over in place of what it names."""

from __future__ import annotations

import inspect
import os
import sys
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np

from cube_sim.errors import ScenarioError
from cube_sim.mission.own.code import OwnCode, source_file
from cube_sim.scenario import Loaded, load, load_mapping
from cube_sim.scenario.fleet_loading import AnyLoaded, LoadedFleet, any_from, load_any
from cube_sim.scenario.loading import loaded_again

NOT_AGAIN = "cannot be flown again from its record"
"""Said of code that a program hands over, before the reason."""
TWIN_PLACES = 11
"""Places at which a path is held against the one made with its arguments."""
AnyScenario = str | os.PathLike[str] | Mapping[str, Any] | Loaded


def loaded_with(
    scenario: AnyScenario,
    overrides: Mapping[str, Any] | None = None,
    controller: Any = None,
    allocator: Any = None,
    path: Any = None,
) -> Loaded:
    """Load what is to be flown.

    What a program hands over takes the place of `control.law`, `allocation.method` and `path`. In the scenario it goes
    by the name under which it would be found again.

    Args:
        scenario: a file, what would stand in one (file names in it are seen from the working directory), or a loaded
            one.
        overrides: dotted path -> value in place of the scenario's.
        controller: function or class as for `control.law.python`.
        allocator: likewise for `allocation.method.python`.
        path: likewise for `path.python`; or a path itself.

    Raises:
        ScenarioError: the scenario cannot be flown; one line per mistake.
    """
    wanted = {"control.law": controller, "allocation.method": allocator, "path": path}
    given = {key: thing for key, thing in wanted.items() if thing is not None}
    named: dict[str, dict[str, Any]] = {key: {"python": name_of(thing)} for key, thing in given.items()}
    for key, thing in given.items():
        if options := options_of(thing):
            named[key]["options"] = options
    if "path" in named:
        named["path"]["type"] = "python"
    for key in named:
        _lay_over(named, key, (overrides or {}).get(key, _below(overrides or {}, key)))
    all_overrides = {**(overrides or {}), **named}
    if isinstance(scenario, Loaded):
        loaded = loaded_again(scenario, all_overrides) if all_overrides else scenario
    elif isinstance(scenario, Mapping):
        loaded = load_mapping(scenario, all_overrides)
    else:
        loaded = load(scenario, all_overrides)
    # One flight is flown: the scenario as it stands, whatever samples of it there are.
    alone = loaded.scenario.model_copy(update={"samples": None})
    return replace(loaded, scenario=alone, given={**loaded.given, **given})


def any_loaded_with(
    scenario: AnyScenario | LoadedFleet,
    overrides: Mapping[str, Any] | None = None,
    controller: Any = None,
    allocator: Any = None,
    path: Any = None,
) -> AnyLoaded:
    """`loaded_with`, of one vehicle or of several; for several no code is handed over.

    Raises:
        ScenarioError: as `loaded_with`.
    """
    handed_over = any(thing is not None for thing in (controller, allocator, path))
    if isinstance(scenario, LoadedFleet):
        if handed_over:
            raise ScenarioError([scenario.mistake("vehicles", "the file names code of your own for each vehicle")])
        before = {override.path: override.value for override in scenario.overrides}
        return any_from(scenario.path, scenario.text, {**before, **overrides}) if overrides else scenario
    if handed_over or not isinstance(scenario, str | os.PathLike):
        return loaded_with(scenario, overrides, controller, allocator, path)
    loaded = load_any(scenario, overrides)
    return loaded if isinstance(loaded, LoadedFleet) else loaded_with(loaded)


def _below(overrides: Mapping[str, Any], key: str) -> Any:
    """What an override of the block around a value says in its place; None for nothing."""
    block, _, last = key.rpartition(".")
    around = overrides.get(block) if block else None
    return around.get(last) if isinstance(around, Mapping) else None


def _lay_over(named: dict[str, dict[str, Any]], key: str, override: Any) -> None:
    """Add what an override says of what a program hands over: its options, and whatever goes with it.

    Raises:
        ScenarioError: it names another thing.
    """
    if override is None:
        return
    if not isinstance(override, Mapping) or "python" in override:
        text = f"override {key}: a program hands over what stands there; say its options alone: {key}.options"
        raise ScenarioError([text])
    options = {**named[key].get("options", {}), **override.get("options", {})}
    named[key] = {**override, **named[key], **({"options": options} if options else {})}


def options_of(thing: Any) -> dict[str, Any]:
    """What a thing is made with that a scenario can hold: numbers, texts, and lists and mappings of them.

    That is the keywords of a partial function, and the arguments of a path's class where they are known.
    """
    if hasattr(thing, "at") and not inspect.isclass(thing):
        return _made_with(thing) or {}
    keywords = thing.keywords if isinstance(thing, partial) else {}
    found = {}
    for name, value in keywords.items():
        with suppress(TypeError):
            found[name] = _plain(value)
    return found


def why_not_again(code: OwnCode) -> str:
    """Why code cannot be made again by who has its record alone; "" where it can."""
    thing = code.make
    if not code.given:
        return code.not_taken
    if isinstance(thing, partial):
        if thing.args or set(options_of(thing)) != set(thing.keywords):
            return "a scenario cannot hold what it is called with"
        thing = thing.func
    named = thing if inspect.isroutine(thing) or inspect.isclass(thing) else type(thing)
    if "<" in getattr(named, "__qualname__", "<"):
        return "it is made within a function"
    if inspect.ismethod(thing) and not inspect.isclass(thing.__self__):
        return "it is the method of an object"
    if not source_file(thing) and getattr(named, "__module__", "") in ("__main__", "builtins"):
        return "it stands in no file"
    if thing is not named and (not hasattr(thing, "at") or _made_with(thing) is None):
        return "it is an object, and what it was made with is not known"
    return code.not_taken


def _made_with(path: Any) -> dict[str, Any] | None:
    """The arguments that make a path once more: its attributes of their names; None where these make another one."""
    try:
        found = {}
        for name, parameter in inspect.signature(type(path)).parameters.items():
            if hasattr(path, name) or parameter.default is parameter.empty:
                found[name] = _plain(getattr(path, name))
        twin = type(path)(**found)
        places = np.linspace(0.0, path.length, TWIN_PLACES).tolist()
        same = twin.length == path.length and twin.closed == path.closed
        same = same and all(_same_point(twin.at(s), path.at(s)) for s in places)
    except Exception:  # whatever a class of the user's own does when it is asked
        return None
    return found if same else None


def _same_point(one: Any, other: Any) -> bool:
    return all(np.array_equal(a, b) for a, b in zip(one, other, strict=True))


def _plain(value: Any) -> Any:
    """A value as YAML has it.

    Raises:
        TypeError: YAML has none.
    """
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, list | tuple):
        return [_plain(each) for each in value]
    if isinstance(value, dict) and all(isinstance(key, str) for key in value):
        return {key: _plain(each) for key, each in value.items()}
    raise TypeError(f"no scenario holds a {type(value).__name__}")


def name_of(thing: Any) -> str:
    """file.py:name of a function, a class or an object's class; package.module:name in packages and without a file."""
    while isinstance(thing, partial):
        thing = thing.func
    named = thing if inspect.isroutine(thing) or inspect.isclass(thing) else type(thing)
    module, file = getattr(named, "__module__", "builtins"), source_file(thing)
    name = getattr(named, "__qualname__", type(named).__qualname__)
    in_package = bool(getattr(sys.modules.get(module), "__package__", ""))
    return f"{module if in_package or not file else file}:{name}"
