"""The JSON schema of scenario files, for editors."""

from __future__ import annotations

import json
from typing import Any

from cube_sim.scenario.fleet import AT_THE_TOP, VEHICLES, WorldBlock
from cube_sim.scenario.schema import Scenario

Schema = dict[str, Any]
_PARTLY = "What of this block is other than at the top of the file."


def json_schema() -> str:
    """The schema as JSON text, ending in a newline."""
    schema = {"$schema": "https://json-schema.org/draft/2020-12/schema", **Scenario.model_json_schema()}
    world = WorldBlock.model_json_schema()
    schema["$defs"] |= {name: block for name, block in world["$defs"].items() if name not in schema["$defs"]}
    # What a file leaves out may stand in the one that it includes.
    required = schema.pop("required")
    legs = [name for name in required if name != "path"]
    phased = [name for name in legs if name != "guidance"]
    ways = ["include"], required, [*legs, "waypoints"], [*phased, "phases"], [*world["required"], VEHICLES]
    schema["anyOf"] = [{"required": way} for way in ways]
    own = {name: _partly(value, schema) for name, value in schema["properties"].items() if name not in AT_THE_TOP}
    schema["$defs"]["VehicleAmong"] = {
        "title": "Vehicle",
        "description": "One of several vehicles: what it has in place of what stands at the top.",
        "type": "object",
        "additionalProperties": False,
        "properties": {name: value for name, value in own.items() if name != "include"},
    }
    checks = {**schema["properties"]["checks"]}
    checks["items"] = {"anyOf": [checks["items"], world["properties"]["checks"]["items"]]}  # those over several too
    schema["properties"]["checks"] = checks
    schema["properties"][VEHICLES] = {
        "title": "Vehicles",
        "description": "Several vehicles in the same water, each by its name. Default: there is one.",
        "type": "object",
        "minProperties": 1,
        "propertyNames": {"pattern": "^[a-z][a-z0-9_]*$"},
        "additionalProperties": {"anyOf": [{"$ref": "#/$defs/VehicleAmong"}, {"type": "null"}]},
    }
    return json.dumps(schema, indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def _partly(value: Schema, schema: Schema) -> Schema:
    """The schema of a block of which a part may be given."""
    if "$ref" not in value:
        return value
    block = schema["$defs"][value["$ref"].rpartition("/")[2]]
    if "required" not in block:
        return value
    return {**{key: each for key, each in block.items() if key != "required"}, "description": _PARTLY}
