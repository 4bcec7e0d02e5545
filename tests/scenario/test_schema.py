"""The format itself: what editors are told, and the habits every key keeps."""

from __future__ import annotations

from typing import Annotated, get_args, get_origin

import pytest
from pydantic import BaseModel
from support.places import SCENARIO_FILES, SCENARIOS

from cube_sim.scenario import Scenario, load
from cube_sim.scenario.json_schema import json_schema

UNITS = (
    "_m", "_s", "_m_s", "_deg", "_deg_s", "_m_s2", "_per_m", "_per_s", "_per_s2", "_N", "_N2", "_hz", "_V",
    "_ohm", "_Wh",
)  # fmt: skip
# Pure numbers, and limits whose unit is that of the signal they judge.
WITHOUT_UNIT = {
    "above",
    "below",
    "offset",
    "size",
    "share",
    "schema_version",
    "seed",
    "value",
    "values",
    "charge",
    "mass",
    "added_mass",
    "drag",
    "thrust",
    "turns",
    "laps",
    "periods",
    "efficiency",
    "fins",
    "scale_error",
    "gain_tolerance",
    "gain",
    "thruster_gains",
    "axis",
    "cost_limit",
    "torque_weight",
    "thruster_weights",
    "dead_zone_margin",
    "at_most",
    "least_denominator",
    "at_least",
    "component",
    "level",  # numbers in the unit of the signal they judge
    "band",
    "percent",
    "phase",
    "tolerance",  # of a check; in the unit of what it compares
    "scale",
    "event",  # the number of one in their list
    "from_event",
    "to_event",
    "components",
    "noise",  # of a sensor of one's own, with the unit it says
    "bias",
    "parameters",  # numerics of the MJCF, each with its own unit
    "low",  # of what is drawn, in the unit of the key it is drawn for
    "high",
    "mean",
    "std",
    "median",
    "log_std",
    "points",
    "weights",
    "count",
    "losses",
    "pass_rate",
    "confidence",
}


def blocks(annotation, seen):
    """Every block class reachable from an annotation."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        if annotation not in seen:
            seen[annotation] = None
            for field in annotation.model_fields.values():
                blocks(field.annotation, seen)
    else:
        for inner in get_args(annotation):
            blocks(inner, seen)
    return seen


def holds_numbers(annotation) -> bool:
    if get_origin(annotation) is Annotated:
        return holds_numbers(get_args(annotation)[0])
    if annotation in (int, float):
        return True
    return any(
        holds_numbers(inner) for inner in get_args(annotation) if inner is not ... and not isinstance(inner, str)
    )


FIELDS = [(block, name) for block in blocks(Scenario, {}) for name in block.model_fields]


def test_the_committed_schema_is_the_generated_one():
    assert (SCENARIOS / "scenario.schema.json").read_text() == json_schema(), (
        "write it anew: cube-sim schema > scenarios/scenario.schema.json"
    )


def test_there_are_scenarios():
    assert SCENARIO_FILES


@pytest.mark.parametrize("path", SCENARIO_FILES, ids=lambda path: path.stem)
def test_every_scenario_is_valid_names_the_schema_and_itself(path):
    loaded = load(path)
    assert loaded.text.startswith("# yaml-language-server: $schema=scenario.schema.json\n")
    assert loaded.scenario.name == path.stem
    assert loaded.scenario.description


@pytest.mark.parametrize(("block", "name"), FIELDS, ids=lambda value: getattr(value, "__name__", value))
def test_every_key_is_described_and_every_number_carries_its_unit(block, name):
    field = block.model_fields[name]
    if holds_numbers(field.annotation):
        assert name in WITHOUT_UNIT or name.endswith(UNITS)
    tag = name in {"type", "kind", "mode", "distribution"}
    a_block = isinstance(field.annotation, type) and issubclass(field.annotation, BaseModel)
    assert tag or a_block or name == "path" or field.description


@pytest.mark.parametrize("block", blocks(Scenario, {}), ids=lambda block: block.__name__)
def test_every_block_is_strict_frozen_and_documented(block):
    config = block.model_config
    assert (config["strict"], config["extra"], config["frozen"], config["allow_inf_nan"]) == (
        True,
        "forbid",
        True,
        False,
    )
    assert block.__doc__
