"""docs/scenario.md: every key of a scenario file, from its JSON schema.

Readers know keys, not classes: sections are named by where a key stands in the file.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

from cube_sim.commands.pages import fleet_section, scenario_examples
from cube_sim.commands.pages.markdown import block, code, heading, link, table
from cube_sim.commands.pages.schema_words import Schema, allowed, default, flow, unit_and_meaning, without_null
from cube_sim.scenario.schema import Scenario

_HEADER = ("key", "unit", "default", "allowed", "meaning")
_TOP = "The keys at the top"
_OWN = "Python of your own"
_INTRODUCTION = """\
<!-- Made by `cube-sim reference scenario > docs/scenario.md` from the schema in cube_sim/scenario/. -->

# Scenario files: every key

A scenario is a YAML 1.2 file that says what is flown and what has to come out of it. Each key carries its unit in its
name. World axes are ENU (z up), body axes FLU (x ahead, y to the left, z up). An unknown key, a wrong type or a number
out of bounds is one line with the place in the file, and nothing is flown.

A whole scenario may be as short as this one:
"""
_HOW_TO = """\
- Editors complete keys and check them as you type: put `# yaml-language-server: $schema=scenario.schema.json` first in
  the file, with `scenario.schema.json` beside it (`cube-sim schema` prints it).
- From the command line, a value is replaced by its path: `--set guidance.speed_m_s=0.3`,
  `--set checks.0.at_most=0.2`. In Python: `cube_sim.run("mission.yaml", {"guidance.speed_m_s": 0.3})`.
- A file can stand on another: `include: base.yaml`, and only what is other than there. Keys take the place of the
  base's, blocks are merged key by key, and the base may include a file in turn. A list (`checks`, `events`, a vector)
  is replaced as a whole. So is a block that names another `type`, `mode` or `kind`; and `path`, `phases` and
  `waypoints` each replace the others. To change one check of a base, give the whole list of checks again, or leave the
  file as it is and use `--set checks.0.at_most=0.2`.
- Each run leaves its scenario with every default written out, `resolved.yaml`.
- Files that a scenario names are looked for from the folder of the scenario file."""


class _Kind(NamedTuple):
    """One member of a block that comes in several kinds.

    Attributes:
        value: what the telling key says.
        block: its schema.
    """

    value: str
    block: Schema


class _Keys:
    """The schema, asked for blocks by the values that refer to them."""

    def __init__(self, schema: Schema) -> None:
        self._definitions: dict[str, Schema] = schema["$defs"]
        self.shown: dict[str, str] = {}
        """Where the keys of each block are listed, by its title."""

    @property
    def blocks(self) -> list[Schema]:
        """All of them."""
        return list(self._definitions.values())

    def block(self, value: Schema) -> Schema | None:
        """The block a value, or each entry of a list, is; None when it is none."""
        value, _ = without_null(_entry(value))
        return self._at(value["$ref"]) if "$ref" in value else None

    def kinds(self, value: Schema) -> tuple[str, list[_Kind]] | None:
        """The key by which the kinds of a block, or of a list's entries, are told apart, and the kinds; or None."""
        value, _ = without_null(_entry(value))
        if "discriminator" not in value:
            return None
        tag = value["discriminator"]["propertyName"]
        blocks = [self._at(member["$ref"]) for member in value["oneOf"]]
        return tag, [_Kind(block["properties"][tag]["const"], block) for block in blocks]

    @property
    def shared(self) -> dict[str, Schema]:
        """The blocks that stand in more than one place, by their titles; each has one section."""
        counted: dict[str, int] = {}
        for parent in self.blocks:
            for value in parent["properties"].values():
                value, _ = without_null(value.get("items", value))
                if "$ref" in value:
                    counted[value["$ref"]] = counted.get(value["$ref"], 0) + 1
        blocks = [self._at(reference) for reference, count in counted.items() if count > 1]
        return {block["title"]: block for block in blocks}

    def named_or_own(self, value: Schema) -> tuple[Schema, Schema] | None:
        """Of a value that is a name or a block in its place, both; or None."""
        value, null = without_null(value)
        named, own = [*value.get("oneOf", ()), None, None][:2]
        if "discriminator" in value or own is None:
            return None
        return ({"anyOf": [named, {"type": "null"}]} if null else named), self._at(own["$ref"])

    def _at(self, reference: str) -> Schema:
        return self._definitions[reference.rpartition("/")[2]]


def _entry(value: Schema) -> Schema:
    """What each entry of a list or of a mapping is; of anything else, itself."""
    below = value.get("additionalProperties")
    return value.get("items", below if isinstance(below, dict) else value)


def _many(value: Schema, of_what: str) -> str:
    """What holds one block, or many, in a word."""
    if "items" in value:
        return f"list of {of_what}s"
    key = "path" if "path" in value.get("description", "") else "name"
    return f"{of_what}s by {key}" if _entry(value) is not value else of_what


def scenario_page() -> str:
    """The page as Markdown text, ending in a newline."""
    schema = Scenario.model_json_schema()
    keys = _Keys(schema)
    parts = [_INTRODUCTION.rstrip(), block(scenario_examples.WHOLE), _HOW_TO, heading(2, _TOP)]
    parts.append(_rows(keys, "", schema))
    parts += _children(keys, "", schema, 2)
    for title, shared in keys.shared.items():
        parts += [heading(2, title), _text(shared["description"]), *_example(title), _rows(keys, title, shared)]
    parts += _own(keys, schema)
    parts += [heading(2, fleet_section.TITLE), fleet_section.TEXT, block(fleet_section.EXAMPLE), fleet_section.CHECKS]
    return "\n\n".join(parts) + "\n"


def _own(keys: _Keys, schema: Schema) -> Iterator[str]:
    """The section of the block that takes the place of a name."""
    values = (value for parent in [schema, *keys.blocks] for value in parent["properties"].values())
    own = next(both[1] for value in values if (both := keys.named_or_own(value)) is not None)
    yield heading(2, _OWN)
    yield _text(own["description"])
    yield from _example(_OWN)
    yield _rows(keys, _OWN, own)


def _children(keys: _Keys, path: str, parent: Schema, level: int, skip: str = "") -> Iterator[str]:
    """The sections of all blocks below a block."""
    for name, value in parent["properties"].items():
        if name == skip:
            continue
        where = f"{path}.{name}" if path else name
        if (below := keys.block(value)) is not None:
            if below["title"] in keys.shared:
                continue
            yield heading(level, _title(where))
            yield _text(below["description"])
            yield from _example(where)
            if (there := keys.shown.setdefault(below["title"], where)) != where:
                yield f"Its keys are those of {link(code(there), _title(there))}."
                continue
            yield _rows(keys, where, below)
            yield from _children(keys, where, below, level + 1)
        elif (kinds := keys.kinds(value)) is not None:
            yield heading(level, _title(where))
            told = [keys.shown.setdefault(kind.block["title"], where) for kind in kinds[1]]
            if where not in told:
                yield f"{_text(value['description'])} Its keys are those of {link(code(told[0]), _title(told[0]))}."
                continue
            yield from _union(keys, where, value, *kinds, level=level)


def _union(keys: _Keys, where: str, value: Schema, tag: str, kinds: list[_Kind], *, level: int) -> Iterator[str]:
    """The sections of a block that comes in several kinds, or of a list of such blocks."""
    who = "Each entry of the list" if "items" in value else "Each" if _entry(value) is not value else "It"
    yield f"{_text(value['description'])} {who} has a key {code(tag)}, which says what other keys it takes:"
    rows = [
        (link(code(kind.value), _title(where, tag, kind.value)), _first_paragraph(kind.block["description"]))
        for kind in kinds
    ]
    yield table((code(tag), "what it is"), rows)
    yield from _example(where)
    for kind in kinds:
        yield heading(level + 1, _title(where, tag, kind.value))
        yield _text(kind.block["description"])
        yield from _example(f"{where}:{kind.value}")
        yield _rows(keys, where, kind.block, skip=tag)
        yield from _children(keys, where, kind.block, level + 2, skip=tag)


def _rows(keys: _Keys, where: str, parent: Schema, skip: str = "") -> str:
    """The table of a block's keys."""
    required = parent.get("required", ())
    rows = [
        _row(keys, f"{where}.{name}" if where else name, name, value, name in required)
        for name, value in parent["properties"].items()
        if name != skip
    ]
    return table(_HEADER, rows) if rows else "It takes no other key."


def _row(keys: _Keys, where: str, name: str, value: Schema, required: bool) -> tuple[str, ...]:
    below, kinds = keys.block(value), keys.kinds(value)
    description = value.get("description") or (below or {}).get("description", "")
    unit, meaning = unit_and_meaning(_text(description))
    if below is not None:
        null = " or `null`" if without_null(value)[1] else ""
        title = below["title"] if below["title"] in keys.shared else _title(where)
        allow, standard = (
            link(_many(value, "block"), title) + null,
            _block_default(keys, value, below, required),
        )
    elif (both := keys.named_or_own(value)) is not None:
        allow = f"{allowed(both[0])}, or a {link('block', _OWN)} that names your own"
        standard = default(value, required)
    elif kinds is not None:
        allow = link(f"{_many(value, 'block')} by {code(kinds[0])}", _title(where))
        standard = default(value, required)
    else:
        allow, standard = allowed(value), default(value, required)
    return code(name), unit, standard, allow, meaning


def _block_default(keys: _Keys, value: Schema, below: Schema, required: bool) -> str:
    if required:
        return "required"
    standard = value["default"]
    if "items" in value:
        return code(flow(standard))
    return "its defaults" if standard == _defaults(keys, below) else code(flow(standard))


def _defaults(keys: _Keys, parent: Schema) -> dict[str, Any]:
    """What a block holds of which no key is given."""
    return {name: value["default"] for name, value in parent["properties"].items() if "default" in value}


def _title(where: str, tag: str = "", value: str = "") -> str:
    return f"{code(where)}, {code(f'{tag}: {value}')}" if tag else code(where)


def _example(where: str) -> Iterator[str]:
    if where in scenario_examples.BLOCKS:
        yield block(scenario_examples.BLOCKS[where])


def _text(description: str) -> str:
    return " ".join(description.split())


def _first_paragraph(description: str) -> str:
    return _text(description.partition("\n\n")[0])
