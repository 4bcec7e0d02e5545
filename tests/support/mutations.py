"""Scenario files with something wrong in them: drawn by a seed, and where it is known, with the line of the cause."""

from __future__ import annotations

import random
import re
from collections.abc import Callable
from typing import NamedTuple

from cube_sim.scenario.document import Document, parse

TAGS = ("type", "kind", "mode")
FREE = ("options", "parameters", "vary", "description", "name", "include")
"""Blocks and values that may hold anything."""


class Mutated(NamedTuple):
    """A file that was changed.

    Attributes:
        what: the name of the change.
        content: of the file.
        lines: one of these is to be named, counted from 1; none where nobody can tell beforehand, or nothing is wrong.
        refused: whether something is certainly wrong now.
    """

    what: str
    content: bytes
    lines: tuple[int, ...] = ()
    refused: bool = False


class _Source:
    """A text and where things stand in it."""

    def __init__(self, text: str) -> None:
        self.text, self.lines = text, text.splitlines()
        self.document: Document = parse(text)
        blocks = {location[:-1] for location in self.document.values if location}
        places = [
            location
            for location in self.document.values
            if location and not set(map(str, location)) & set(FREE) and not self.folded(location)
        ]
        self.leaves = [location for location in places if location not in blocks]
        self.keys = [location for location in places if isinstance(location[-1], str) and location[-1] not in TAGS]

    def folded(self, location) -> bool:
        line = self.lines[self.document.values[location].line - 1]
        return line.rstrip().endswith((">-", "|", ">", "|-"))

    def value(self, location):
        """Line (from 0), column (from 0) and end of the scalar there."""
        line, column, _ = self.document.values[location]
        rest = self.lines[line - 1][column - 1 :]
        written = re.match(r"\"[^\"]*\"|'[^']*'|[^\s,\]}#]*", rest)
        return line - 1, column - 1, column - 1 + (written.end() if written else 0)

    def with_value(self, location, new: str) -> tuple[str, int]:
        """The text with another value there, and its line from 1."""
        line, start, end = self.value(location)
        lines = list(self.lines)
        lines[line] = lines[line][:start] + new + lines[line][end:]
        return "\n".join(lines) + "\n", line + 1

    def with_line(self, index: int, *new: str) -> str:
        return "\n".join([*self.lines[:index], *new, *self.lines[index + 1 :]]) + "\n"


def _encoded(text: str) -> bytes:
    return text.encode("utf-8", "surrogateescape")


def _misspelt(source: _Source, draw: random.Random) -> Mutated:
    location = draw.choice(source.keys)
    line, column, _ = source.document.keys[location]
    key = str(location[-1])
    at = draw.randrange(len(key))
    wrong = key[:at] + "zq" + key[at:]
    text = source.lines[line - 1]
    changed = source.with_line(line - 1, text[: column - 1] + wrong + text[column - 1 + len(key) :])
    return Mutated("misspelt key", _encoded(changed), (line,), True)


def _put(
    what: str, values: tuple[str, ...], numbers_only: bool = False, certain: bool = True, but: tuple[str, ...] = ()
):
    """A change that puts one of these values somewhere, but not into blocks of these names."""

    def change(source: _Source, draw: random.Random) -> Mutated:
        leaves = [each for each in source.leaves if each[0] not in but]
        if numbers_only:
            numbers = [each for each in leaves if _is_number(source, each)]
            leaves = numbers or leaves
        location = draw.choice([each for each in leaves if each[-1] not in TAGS] or leaves)
        text, line = source.with_value(location, draw.choice(values))
        return Mutated(what, _encoded(text), (line,) if certain else (), certain)

    return change


def _is_number(source: _Source, location) -> bool:
    here = source.document.data
    for step in location:
        here = here[step]
    return isinstance(here, int | float) and not isinstance(here, bool)


def _quote_opened(source: _Source, draw: random.Random) -> Mutated:
    location = draw.choice(source.leaves)
    line, start, _ = source.value(location)
    text = source.lines[line]
    mark = draw.choice("\"'")
    if mark in text:  # a quote that is there closes it
        return _misspelt(source, draw)
    return Mutated(
        "opened quote", _encoded(source.with_line(line, text[:start] + mark + text[start:])), (line + 1,), True
    )


def _bracket_lost(source: _Source, draw: random.Random) -> Mutated:
    closed = [i for i, line in enumerate(source.lines) if line.count("[") + line.count("{") and "#" not in line]
    index = draw.choice(closed or [0])
    text = source.lines[index]
    at = max(text.rfind("]"), text.rfind("}"))
    if at < 0:
        return _misspelt(source, draw)
    return Mutated("lost bracket", _encoded(source.with_line(index, text[:at] + text[at + 1 :])), (index + 1,), True)


def _before_a_line(what: str, *new: str):
    def change(source: _Source, draw: random.Random) -> Mutated:
        tops = [i for i, line in enumerate(source.lines) if re.match(r"[a-z_]+:", line)]
        index = draw.choice(tops[1:] or tops)
        changed = source.with_line(index, *new, source.lines[index])
        return Mutated(what, _encoded(changed), tuple(range(index + 1, index + 1 + len(new))), True)

    return change


def _character(what: str, inserted: bytes):
    def change(source: _Source, draw: random.Random) -> Mutated:
        index = draw.randrange(len(source.lines))
        content = _encoded("\n".join(source.lines[:index]) + ("\n" if index else "")) + inserted
        return Mutated(what, content + _encoded("\n".join(source.lines[index:]) + "\n"), (index + 1,), True)

    return change


def _text_change(what: str, change: Callable[[_Source, random.Random], str]):
    return lambda source, draw: Mutated(what, _encoded(change(source, draw)))


def _line_dropped(source: _Source, draw: random.Random) -> str:
    return source.with_line(draw.randrange(len(source.lines)))


def _line_doubled(source: _Source, draw: random.Random) -> str:
    index = draw.randrange(len(source.lines))
    return source.with_line(index, source.lines[index], source.lines[index])


def _line_moved(source: _Source, draw: random.Random) -> str:
    lines = list(source.lines)
    line = lines.pop(draw.randrange(len(lines)))
    lines.insert(draw.randrange(len(lines) + 1), line)
    return "\n".join(lines)


def _line_indented(source: _Source, draw: random.Random) -> str:
    index = draw.randrange(len(source.lines))
    text = source.lines[index]
    return source.with_line(
        index, draw.choice((" ", "  ", "   ", "\t")) + text if draw.random() < 0.7 else text.lstrip()
    )


def _cut(source: _Source, draw: random.Random) -> str:
    return source.text[: draw.randrange(len(source.text))]


def _bytes_flipped(source: _Source, draw: random.Random) -> Mutated:
    content = bytearray(_encoded(source.text))
    for _ in range(draw.choice((1, 1, 2, 5))):
        content[draw.randrange(len(content))] ^= 1 << draw.randrange(8)
    return Mutated("flipped bytes", bytes(content))


def _punctuation(source: _Source, draw: random.Random) -> str:
    at = draw.randrange(len(source.text))
    sign = draw.choice(":{}[],&*#?|->%@`!'\"\t\\")
    return source.text[:at] + sign + source.text[at + draw.choice((0, 1)) :]


def _encoding(source: _Source, draw: random.Random) -> Mutated:
    codec = draw.choice(("utf-16", "utf-16-le", "utf-32", "cp037"))
    return Mutated(f"as {codec}", source.text.encode(codec, "replace"), refused=True)


def _harmless(source: _Source, draw: random.Random) -> Mutated:
    change = draw.choice((
        lambda text: text.replace("\n", "\r\n"),
        lambda text: "\ufeff" + text,
        lambda text: text + "\n\n# the end\n",
        lambda text: "%YAML 1.2\n---\n" + text,
        lambda text: text.rstrip("\n"),
    ))  # fmt: skip
    return Mutated("harmless", _encoded(change(source.text)))


def _large(source: _Source, draw: random.Random) -> Mutated:
    match draw.randrange(3):
        case 0:
            return Mutated("huge", _encoded(source.text + "# more\n" * 150_000), refused=True)
        case 1:
            many = ", ".join(["0"] * 3_000)
            text, _ = source.with_value(draw.choice(source.leaves), f"[{many}]")
            return Mutated("long list", _encoded(text))
        case _:
            return Mutated(
                "many keys", _encoded(source.text + "".join(f"k{i}: {i}\n" for i in range(400))), refused=True
            )


CHANGES: dict[str, Callable[[_Source, random.Random], Mutated]] = {
    "misspelt": _misspelt,
    "typed": _put("another type", ("{no: 1}", "[[[]]]", "!!set {a}", "2001-01-01", "[{a: b}]")),
    "not finite": _put("not finite", (".nan", ".inf", "-.inf", "9" * 400), numbers_only=True),
    # What is compared with may be any number, and samples are held against the bounds of what they vary.
    "extreme": _put("extreme", ("1.0e+300", "-1.0e+300"), numbers_only=True, but=("checks", "samples")),
    "small": _put("small", ("0", "-0.0", "1.0e-300", "5.0e-324", "-1", "0x10", "1e3"), True, certain=False),
    "boolean": _put("boolean or text", ("true", "yes", "'3'", "~x", "abc"), numbers_only=True),
    "empty": _put("emptied", ("", "~", "null"), certain=False),
    "alias": _put("undefined alias", ("*nowhere",)),
    "tag": _put("tag", ("!!python/object/apply:os.system [x]", "!secret x", "!!binary x", "!<tag:x> 1")),
    "anchor": _put("anchored", ("&here 1", "&here"), certain=False),
    "itself": _put("itself", ("&loop [*loop]",)),
    "nested": _put("nested", ("[" * 200 + "]" * 200, "{a: " * 100 + "1" + "}" * 100)),
    "quote": _quote_opened,
    "bracket": _bracket_lost,
    "merge": _before_a_line("merge key", "<<: {seed: 3}"),
    "document": _before_a_line("another document", "---"),
    "tab": _before_a_line("tab", "\tseed: 3"),
    "prose": _before_a_line("prose", "this is no key"),
    "tower": _before_a_line("tower", "a0: &a0 [1,1,1,1,1,1,1,1]", *(f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 8)}]"
                                                                     for k in range(1, 8))),
    "control": _character("control character", b"\x07"),
    "nul": _character("NUL", b"\x00"),
    "utf8": _character("no UTF-8", b"\xc3\x28"),
    "dropped": _text_change("dropped line", _line_dropped),
    "doubled": _text_change("doubled line", _line_doubled),
    "moved": _text_change("moved line", _line_moved),
    "indented": _text_change("indented line", _line_indented),
    "cut": _text_change("cut off", _cut),
    "punctuation": _text_change("punctuation", _punctuation),
    "flipped": _bytes_flipped,
    "encoding": _encoding,
    "harmless": _harmless,
    "large": _large,
}  # fmt: skip
"""By name; each is drawn as often as the others, but for the large, which take long."""


def mutated(texts: dict[str, str], seed: int) -> tuple[str, Mutated]:
    """A text's name, and what became of it.

    Args:
        texts: of valid scenarios, by name.
        seed: of the draw; the kinds of change are gone through by it.
    """
    draw = random.Random(seed)
    kinds = list(CHANGES)
    kind = kinds[seed % len(kinds)]
    if kind == "large" and seed % 4:
        kind = draw.choice(kinds[:-1])
    name = draw.choice(sorted(texts))
    if name not in _sources:
        _sources[name] = _Source(texts[name])
    return name, CHANGES[kind](_sources[name], draw)


_sources: dict[str, _Source] = {}
