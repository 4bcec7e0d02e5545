"""What the schema refuses, said as a location in the file and one sentence a user can act on."""

from __future__ import annotations

import difflib
import reprlib
from collections.abc import Sequence
from typing import Annotated, Any, Literal, NamedTuple, get_args, get_origin

from pydantic import BaseModel, Tag, ValidationError

from cube_sim.scenario.document import Location

_short = reprlib.Repr()
_short.maxlevel, _short.maxlist, _short.maxdict, _short.maxstring, _short.maxother = 2, 8, 4, 60, 60


class Refusal(NamedTuple):
    """One thing the schema refuses.

    Attributes:
        location: keys and indices as written in the file.
        message: what is wrong and what would be right.
        at_key: whether the key itself is wrong, not its value.
        because: another value the refused one does not fit, () when it is wrong by itself.
    """

    location: Location
    message: str
    at_key: bool
    because: Location = ()


def explain(error: ValidationError, model: type[BaseModel]) -> list[Refusal]:
    """Turn every error of a validation into a refusal, in the schema's order.

    A required key that is missing because it is misspelt is one mistake, not two.
    """
    refusals: list[Refusal] = []
    missing: set[Location] = set()
    misspelt: set[Location] = set()
    found = error.errors(include_url=False)
    entered = {each["loc"][:-1] for each in found if each["loc"]}
    for item in found:
        if item["type"] == "too_short" and item["loc"] in entered:
            continue  # of a list with a wrong entry, what is left is counted
        location, block = _follow(model, item["loc"])
        context = item.get("ctx", {})
        location += tuple(context.get("below", ()))
        kind = item["type"]
        if (
            kind == "union_tag_invalid"
            and isinstance(item["input"], dict)
            and (told := _discriminator(block)) in item["input"]
        ):
            location += (told,)
        message = _message(kind, location, item["input"], context, block) or item["msg"]
        because = tuple(context.get("because", ()))
        refusals.append(Refusal(location, message, at_key=kind == "extra_forbidden", because=because))
        if kind == "missing":
            missing.add(location)
        elif kind == "extra_forbidden" and (near := _nearest(str(location[-1]), _field_names(block))):
            misspelt.add((*location[:-1], near))
    return [refusal for refusal in refusals if refusal.location not in missing & misspelt]


def _message(kind: str, location: Location, value: Any, context: dict[str, Any], block: Any) -> str | None:
    got = f"got {_describe(value)}"
    match kind:
        case "refused":
            return context["text"]
        case "extra_forbidden":
            return f"unknown key{_suggest(str(location[-1]), _field_names(block))}"
        case "missing":
            if isinstance(location[-1], int):
                return "a number is missing here: the list is too short"
            return "this key is required"
        case "union_tag_not_found":
            return f"needs the key {_discriminator(block)}: one of {', '.join(_tags(block))}"
        case "union_tag_invalid":
            return f"unknown {_discriminator(block)} {context['tag']!r}{_suggest(context['tag'], _tags(block))}"
        case "literal_error":
            choices = [str(choice) for choice in get_args(block)]
            if len(choices) == 1:
                return f"must be {choices[0]}, {got}"
            return f"{got}{_suggest(str(value), choices)}"
        case "float_type" | "int_type" | "int_from_float":
            return f"must be a {'number' if kind == 'float_type' else 'whole number'}, {got}"
        case "finite_number":
            return f"must be finite, {got}"
        case "bool_type":
            return f"must be true or false, {got}"
        case "string_type":
            return f"must be text, {got}"
        case "string_too_short":
            return "must not be empty"
        case "string_too_long":
            return f"must have at most {context['max_length']} characters, has {len(value)}"
        case "string_pattern_mismatch":
            return f"must match {context['pattern']}, {got}"
        case "tuple_type":
            return f"must be a list, {got}"
        case "too_long":
            return f"must have {context['max_length']} entries, has {context['actual_length']}"
        case "too_short":
            return f"must have {context['min_length']} or more entries, has {len(value)}"
        case "model_type" | "model_attributes_type" | "dict_type":
            return f"must be a block of keys, {got}"
        case "greater_than":
            return f"must be greater than {context['gt']:g}, {got}"
        case "greater_than_equal":
            return f"must be at least {context['ge']:g}, {got}"
        case "less_than":
            return f"must be less than {context['lt']:g}, {got}"
        case "less_than_equal":
            return f"must be at most {context['le']:g}, {got}"
    return None


def _describe(value: Any) -> str:
    if value is None:
        return "nothing"
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return f"the text {_short.repr(value)}"
    if isinstance(value, int | float):
        return _short.repr(value)
    if isinstance(value, dict):
        return "a block of keys"
    if isinstance(value, list | tuple):
        return f"the list {_short.repr(list(value))}"
    return f"{type(value).__name__} {_short.repr(value)}"


def _nearest(word: str, known: Sequence[str]) -> str | None:
    parts = [name for name in known if word.lower() in name.lower().split("_")]
    if len(parts) == 1:  # `path` is along_path, though more of its letters are those of `python`
        return parts[0]
    return next(iter(difflib.get_close_matches(word, known, n=1, cutoff=0.6)), None)


def _suggest(word: str, known: Sequence[str]) -> str:
    near = _nearest(word, known)
    return f"; did you mean {near}?" if near else f"; known: {', '.join(known)}"


def _follow(model: type[BaseModel], loc: Sequence[str | int]) -> tuple[Location, Any]:
    """Walk the schema along an error's path.

    The path names the chosen member of a union, which the file does not: such steps are dropped.

    Returns:
        The location as written in the file, and the annotation that judged there (for an unknown key, its
        block).
    """
    here: Any = model
    location: list[str | int] = []
    for step in loc:
        here = _bare(here)
        if get_origin(here) is not None and not isinstance(step, int):
            chosen = [member for member in _members(here) if step in _tag_values(member)]
            if chosen:
                here = chosen[0]
                continue
        location.append(step)
        if get_origin(here) is dict:
            here = get_args(here)[1]
        elif isinstance(step, int):
            inner = get_args(here)
            here = inner[0] if inner and (inner[-1] is ... or step >= len(inner)) else (inner[step] if inner else here)
        elif isinstance(here, type) and issubclass(here, BaseModel) and step in here.model_fields:
            here = here.model_fields[step].annotation
    return tuple(location), _bare(here)


def _bare(annotation: Any) -> Any:
    """An annotation without Annotated[...] and without `| None`."""
    while True:
        if get_origin(annotation) is Annotated:
            annotation = get_args(annotation)[0]
            continue
        members = _members(annotation)
        if members and type(None) in members:
            others = [member for member in members if member is not type(None)]
            if len(others) == 1:
                annotation = others[0]
                continue
        return annotation


def _members(annotation: Any) -> tuple[Any, ...]:
    origin = get_origin(annotation)
    return () if origin in (None, tuple, Literal, Annotated) else get_args(annotation)


def _tag_field(member: Any) -> str | None:
    """Name of the field that tells the members of a union apart: of those with words of their own the pickiest."""
    if not (isinstance(member, type) and issubclass(member, BaseModel)):
        return None
    fields = member.model_fields.items()
    words = {
        name: len(get_args(i.annotation))
        for name, i in fields
        if get_origin(i.annotation) is Literal and i.is_required()
    }
    return min(words, key=lambda name: words[name], default=None)


def _tag_values(member: Any) -> tuple[Any, ...]:
    if get_origin(member) is Annotated:
        return tuple(mark.tag for mark in get_args(member)[1:] if isinstance(mark, Tag))
    name = _tag_field(member)
    return () if name is None else get_args(member.model_fields[name].annotation)


def _discriminator(union: Any) -> str:
    return next(filter(None, map(_tag_field, _members(union))), "type")


def _tags(union: Any) -> list[str]:
    return [str(tag) for member in _members(union) for tag in _tag_values(member)]


def _field_names(block: Any) -> list[str]:
    return list(block.model_fields) if isinstance(block, type) and issubclass(block, BaseModel) else []
