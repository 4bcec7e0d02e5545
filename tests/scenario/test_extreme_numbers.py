"""Every number of a scenario at its extremes: a mistake with a place, or a run that ends with a reason."""

from __future__ import annotations

import json
import re
import traceback
import warnings
from collections.abc import Iterator
from types import NoneType
from typing import Any, get_args, get_origin

import pytest
from support.places import MODELS, SCENARIOS

from cube_sim import fly
from cube_sim.commands.pages import scenario_examples
from cube_sim.errors import CubeSimError, ScenarioError
from cube_sim.scenario import Scenario, load
from cube_sim.scenario.document import parse
from cube_sim.scenario.values import Block

JUDGED_OR_DRAWN = ("checks", "samples")
"""Numbers that are compared, or are held against the bounds of others."""
EXTREMES = (0, 0.0, -0.0, 1e-300, -1e-300, 5e-324, 1e300, -1e300, float("nan"), float("inf"), -float("inf"))
EXTREMES += (10**400, -(10**400), 2**63, 2**64, True, False, "3", "", None, [], {}, [1.0], "1e5")
LADDER = tuple(sign * 10.0**power for sign in (-1, 1) for power in (-300, -100, *range(-12, 13), 100, 300))

BLOCKS = {name: parse(text).data for name, text in scenario_examples.BLOCKS.items()}
ALL = {"duration_s": 0.4, "physics": {}, "thrusters": {"dead_zone_N": [-2, 2]}} | {
    key: BLOCKS[key][key] for key in ("battery", "knowledge", "telemetry", "allocation")
}
ALL |= {"navigation": {"position": {"rate_hz": 10}}}
ALL["events"] = [
    {"kind": "thrusters", "at_s": 0.1, "thrusters": ["T2"], "state": "weak", "efficiency": 0.5},
    {"kind": "thrusters", "at_s": 0.1, "thrusters": ["T3"], "state": "stuck", "force_N": 5.0},
    {"kind": "current", "at_s": 0.2, "current_m_s": [0, 0.2, 0], "over_s": 0.1},
    {"kind": "force", "at_s": 0.1, "for_s": 0.1, "over_s": 0.05, "force_N": [5, 0, 1], "point_m": [0.1, 0, 0]},
    {"kind": "sensor", "sensor": "dvl", "at_s": 0.1, "for_s": 0.2, "state": "lost", "tilt_above_deg": 20},
    {"kind": "sensor", "sensor": "depth", "at_s": 0.1, "state": "outliers", "share": 0.5, "size": 2},
    {"kind": "sensor", "sensor": "depth", "at_s": 0.2, "state": "biased", "offset": [0.5]},
    {"kind": "sensor", "sensor": "heading", "at_s": 0.1, "state": "late", "delay_s": 0.1},
]
ALL["checks"] = [
    {"kind": "signal", "signal": "pose.position", "component": 2, "statistic": "max", "at_most": -4, "to_s": 0.3},
    {"kind": "signal", "signal": "pose.position", "statistic": "rms", "at_least": 1, "from_s": 0.1},
    {"kind": "path_end", "reach_m": 0.5},
    {"kind": "allowed_forces"},
    {"kind": "exact_wrench"},
]
PLANAR = parse((SCENARIOS / "infante_circle_current.yaml").read_text()).data | {
    "duration_s": 0.4,
    "checks": [ALL["checks"][0]],
}
PATHS = {name: block | {"duration_s": 0.4} for name, block in BLOCKS.items() if name.startswith("path:")}
MODES = {
    "fixed": {"mode": "fixed", "attitude_deg": [0, 0, 10]},
    "look_at": {"mode": "look_at", "point_m": [0, 0, -6]},
}
FILES: dict[str, dict[str, Any]] = {
    "all": ALL,
    "planar": PLANAR,
    **PATHS,
    **{mode: {"duration_s": 0.4, "control": {"attitude": block}} for mode, block in MODES.items()},
    "profile": {
        "duration_s": 0.4,
        "current_profile": {"depths_m": [0, 5, 10], "velocities_m_s": [[0.1, 0, 0], [0, 0.1, 0], [0, 0, 0]]},
    },
    "surface": {"duration_s": 0.4, "control": BLOCKS["control.safe_mode"]["control"]},
}


def loaded_numbers(block: Block, path: str = "") -> Iterator[str]:
    """Dotted paths of every value that is a number, or may be one and is left out."""
    for key, field in type(block).model_fields.items():
        value, here = getattr(block, key), f"{path}.{key}" if path else key
        may_be = set(_plain_types(field.annotation))
        if value is None and may_be & {int, float} and NoneType in may_be:
            yield here
        yield from _numbers_in(value, here)


def _numbers_in(value: Any, here: str) -> Iterator[str]:
    if isinstance(value, Block):
        yield from loaded_numbers(value, here)
    elif isinstance(value, tuple):
        for index, item in enumerate(value):
            yield from _numbers_in(item, f"{here}.{index}")
    elif isinstance(value, int | float) and not isinstance(value, bool):
        yield here


def _plain_types(annotation: Any) -> Iterator[Any]:
    if get_origin(annotation) is tuple:
        return
    yield annotation
    for inner in get_args(annotation):
        yield from _plain_types(inner)


@pytest.fixture
def written(tmp_path):
    """Write a scenario of `FILES` with every number in it, beside what it names; returns its path."""

    def write(name: str):
        content = parse(scenario_examples.WHOLE).data | FILES[name]
        (tmp_path / "scenarios").mkdir(exist_ok=True)
        if not (tmp_path / "models").exists():
            (tmp_path / "models").symlink_to(MODELS)
        (tmp_path / "scenarios" / "survey.csv").write_text("x_m,y_m,z_m\n0,0,-5\n8,0,-5\n8,8,-5\n")
        path = tmp_path / "scenarios" / f"{name.replace(':', '_')}.yaml"
        path.write_text(json.dumps(content))
        path.write_text(load(path).resolved_yaml(path.parent))
        return path

    return write


def own_numbers(path, name: str) -> list[str]:
    """Those in the blocks that a scenario of `FILES` is there for."""
    numbers = list(loaded_numbers(load(path).scenario))
    return numbers if name in ("all", "planar") else [each for each in numbers if each.split(".")[0] in FILES[name]]


def refusal(path, number: str, value: Any) -> list[str]:
    """What is wrong with a number, in lines; none where it is taken."""
    try:
        load(path, {number: value})
    except ScenarioError as error:
        return error.mistakes
    return []


def test_every_number_that_is_flown_with_has_two_bounds():
    """Without them it could overflow in whatever is computed of it."""
    schema = Scenario.model_json_schema()
    unbounded, seen = [], set()

    def walk(node: Any, place: str) -> None:
        if isinstance(node, list):
            for index, below in enumerate(node):
                walk(below, f"{place}.{index}")
        if not isinstance(node, dict):
            return
        ends = {"minimum", "exclusiveMinimum"} & set(node), {"maximum", "exclusiveMaximum"} & set(node)
        if node.get("type") in ("number", "integer") and not all(ends) and "const" not in node:
            unbounded.append(place)
        reference = node.get("$ref")
        if reference is not None and reference not in seen:
            seen.add(reference)
            walk(schema["$defs"][reference.rpartition("/")[2]], place)
        for key, below in node.items():
            walk(below, f"{place}.{key}")

    for key, block in schema["properties"].items():
        if key not in JUDGED_OR_DRAWN:
            walk(block, key)
    assert len(seen) > 20
    assert unbounded == []


@pytest.mark.parametrize("name", FILES)
def test_every_number_at_its_extremes_is_taken_or_refused_where_it_stands(name, written):
    path = written(name)
    numbers = own_numbers(path, name)
    assert numbers
    for number in numbers:
        place = re.compile(rf"override {re.escape(number)}: |{re.escape(str(path))}:[1-9]\d*:[1-9]\d*: ")
        refused = set()
        for value in EXTREMES:
            lines = refusal(path, number, value)
            refused |= {str(value)} if lines else set()
            for line in lines:
                assert place.match(line), (number, value, line)
                assert "\n" not in line
                assert len(line) < 600, (number, value, line)
        always = {"nan", "inf", "-inf", "True", "3"} | (set() if number.startswith("checks") else {"1e+300"})
        assert refused >= always, number


@pytest.mark.flight
@pytest.mark.campaign
@pytest.mark.parametrize("name", FILES)
def test_what_is_taken_at_an_extreme_flies_to_an_end_with_a_reason(name, written, tmp_path):
    """The least, the largest and the smallest of each number that are taken."""
    path = written(name)
    unforeseen, flown = [], 0
    for number in own_numbers(path, name):
        if number in ("duration_s", "physics.step_s"):  # these say how long it takes, not what happens
            continue
        taken = [value for value in LADDER if not refusal(path, number, value)]
        for value in {min(taken), max(taken), min(taken, key=abs)} if taken else ():
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                try:
                    run = fly(path, {number: value}, out=tmp_path / "out", record="none")
                except CubeSimError:  # refused before the flight, or ended by what it was
                    continue
                except Exception as error:
                    where = traceback.extract_tb(error.__traceback__)[-1]
                    unforeseen.append(f"{number}={value:g}: {type(error).__name__}: {error} ({where.name})")
                    continue
            flown += 1
            assert run.verdict in ("PASS", "FAIL") or run.ended_early or any(check.detail for check in run.checks)
    assert unforeseen == []
    assert flown
