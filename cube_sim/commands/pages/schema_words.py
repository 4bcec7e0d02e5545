"""What a JSON schema says of one value, in words: its unit, what is allowed, its default."""

from __future__ import annotations

import re
from typing import Any

from cube_sim.commands.pages.markdown import code

Schema = dict[str, Any]

_UNIT = re.compile(r" \[((?:1|N m|[A-Za-z()]+(?:\^\d)?)(?:/[A-Za-z()]+(?:\^\d)?)*)\]")
_TYPES = {"number": "number", "integer": "whole number", "string": "text", "boolean": "`true` or `false`"}


def unit_and_meaning(description: str) -> tuple[str, str]:
    """The unit a description gives in brackets, "" without one, and the description without it."""
    units = _UNIT.findall(description)
    return (units[0] if units else ""), _UNIT.sub("", description)


def without_null(schema: Schema) -> tuple[Schema, bool]:
    """The schema of what is not null, and whether null is allowed beside it."""
    members = schema.get("anyOf", [schema])
    others = [member for member in members if member.get("type") != "null"]
    return others[0], len(others) < len(members)


def allowed(schema: Schema) -> str:
    """Which values are allowed: type, choices, bounds; of a value that is no block.

    Raises:
        ValueError: the schema uses a word for which there are none here yet.
    """
    first, null = without_null(schema)
    others = [member for member in schema.get("anyOf", [first]) if member.get("type") != "null"]
    words = ", or a ".join(_allowed(other) for member in others for other in member.get("anyOf", [member]))
    return f"{words}{' or `null`' if null else ''}"


def _allowed(schema: Schema) -> str:
    if "const" in schema:
        return code(_plain(schema["const"]))
    if "enum" in schema:
        return ", ".join(code(choice) for choice in schema["enum"])
    if schema.get("additionalProperties") is True:
        return "block of any keys"
    if "additionalProperties" in schema and "properties" not in schema:
        return f"block of any keys, each a {_list(schema['additionalProperties'])}"
    kind = schema.get("type")
    if kind == "array":
        return _list(schema)
    if schema.keys() <= {"default", "description", "title"}:
        return "anything"
    if kind not in _TYPES:
        raise ValueError(f"nothing says in words what {schema} allows")
    words = [_TYPES[kind], _bounds(schema)]
    if "maxLength" in schema:
        words.append(f"of {schema['maxLength']} characters at most")
    if "pattern" in schema:
        words.append(f"matching {code(schema['pattern'])}")
    return " ".join(filter(None, words))


def _list(schema: Schema) -> str:
    fixed = schema.get("prefixItems")
    item = fixed[0] if fixed else schema["items"]
    least = ", at least one" if schema.get("minItems") == 1 else ""
    if not item:
        return f"list of anything{least}"
    count = f"{len(fixed)} " if fixed else ""
    if item["type"] == "array":
        return f"list of {count}lists, each a {_list(item)}"
    bounds = _bounds(item)
    each = f", each {bounds}" if bounds else ""
    return f"list of {count}{_TYPES[item['type']]}s{each}{least}"


def _bounds(schema: Schema) -> str:
    low, high = schema.get("minimum"), schema.get("maximum")
    above, below = schema.get("exclusiveMinimum"), schema.get("exclusiveMaximum")
    if low is not None and high is not None:
        return f"{number(low)} to {number(high)}"
    signs = ((">", above), ("≥", low), ("<", below), ("≤", high))
    return ", ".join(f"{sign} {number(bound)}" for sign, bound in signs if bound is not None)


def default(schema: Schema, required: bool) -> str:
    """What holds when the key is left out; of a value that is no block."""
    return "required" if required else code(flow(schema["default"]))


def flow(value: Any) -> str:
    """A plain value as YAML on one line."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {flow(item)}" for key, item in value.items()) + "}"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(flow, value)) + "]"
    if value == "":
        return '""'
    return str(_plain(value))


def _plain(value: Any) -> str:
    if value is None:
        return "null"
    if isinstance(value, bool):
        return "true" if value else "false"
    return number(value) if isinstance(value, int | float) else str(value)


def number(value: float) -> str:
    """A number without superfluous digits: 60, 0.5, 1e5, 2^63."""
    if isinstance(value, int) and value > 2**53 and value.bit_count() == 1:
        return f"2^{value.bit_length() - 1}"
    digits, _, exponent = f"{value:.5e}".partition("e")
    if -4 <= int(exponent) < 5:
        return f"{value:.6g}"
    return f"{float(digits):g}e{int(exponent)}"
