"""The JSON schema of scenario files, for editors."""

from __future__ import annotations

import json

from cube_sim.scenario.schema import Scenario


def json_schema() -> str:
    """The schema as JSON text, ending in a newline."""
    schema = {"$schema": "https://json-schema.org/draft/2020-12/schema", **Scenario.model_json_schema()}
    # What a file leaves out may stand in the one that it includes.
    required = schema.pop("required")
    schema["anyOf"] = [{"required": ["include"]}, {"required": required}]
    return json.dumps(schema, indent=2, ensure_ascii=False, allow_nan=False) + "\n"
