"""Which samples count for the rate that is required, and how each of them came out.

Where the notes of a generator say beforehand whether a sample should pass, what comes out as they say has passed.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

import pyarrow as pa

from cube_sim.campaign.rows import is_note
from cube_sim.campaign.sample_flight import NOTE
from cube_sim.scenario.samples_block import RequiredBlock

LONGEST = 60
"""A note of more letters is a sentence."""
EVERY = RequiredBlock()
"""Where the scenario requires nothing: every sample has to pass."""


@dataclass(frozen=True)
class Counted:
    """What samples came to, as they are required to.

    Attributes:
        passed: how many passed.
        failed: how many failed.
        errors: how many could not be judged.
        words: what is counted, and what those that passed did: "samples pass".
        among: numbers of the samples that count.
        against: numbers of those of them because of which something has not passed.
    """

    passed: int
    failed: int
    errors: int
    words: str
    among: frozenset[int]
    against: frozenset[int]

    @property
    def count(self) -> int:
        """How many are counted."""
        return self.passed + self.failed + self.errors


def counted(rows: pa.Table, required: RequiredBlock | None) -> Counted:
    """Count what passes; an error of which no note is known, as of one that could not be drawn, is in no case left out.

    Args:
        rows: of a sweep.
        required: what is asked of them; None: that every one passes.
    """
    asked = required or EVERY
    names = [name for name in rows.column_names if is_note(name)]
    told = [_Told(*row.values()) for row in rows.select(["sample", "verdict"]).to_pylist()]
    notes = rows.select(names).to_pylist() if names else [{}] * len(told)
    groups: dict[Any, list[tuple[_Told, bool | None]]] = {}
    for one, noted in zip(told, notes, strict=True):
        undrawn = one.verdict == "ERROR" and all(said is None for said in noted.values())
        if not undrawn and any(noted.get(f"{NOTE}.{name}") != value for name, value in asked.where.items()):
            continue
        group = one.sample if asked.each is None else (noted.get(f"{NOTE}.{asked.each}"),)
        groups.setdefault(group, []).append((one, _should(noted, asked)))
    came = {"PASS": 0, "FAIL": 0, "ERROR": 0}
    among: set[int] = set()
    against: set[int] = set()
    for members in groups.values():
        among |= {one.sample for one, _ in members}
        bad = _against(members)
        against |= {one.sample for one in bad}
        came["PASS" if not bad else "ERROR" if all(one.verdict == "ERROR" for one in bad) else "FAIL"] += 1
    return Counted(came["PASS"], came["FAIL"], came["ERROR"], _words(asked), frozenset(among), frozenset(against))


class _Told(NamedTuple):
    sample: int
    verdict: str


def _should(noted: Mapping[str, Any], asked: RequiredBlock) -> bool | None:
    """Whether a sample should pass; None where nobody has said it."""
    if asked.forecast is None:
        return True
    said = noted.get(f"{NOTE}.{asked.forecast}")
    return said if isinstance(said, bool) else None


def _against(members: list[tuple[_Told, bool | None]]) -> list[_Told]:
    """Samples because of which a group has not come out as it should."""
    if any(should is None for _, should in members):
        return [one for one, should in members if should is None]
    bad = [one for one, _ in members if one.verdict != "PASS"]
    if all(should for _, should in members):
        return bad
    return [] if bad else [one for one, _ in members]


def _words(asked: RequiredBlock) -> str:
    those = "".join(f", {name} {_plain(value)}" for name, value in asked.where.items())
    those += "," if those else ""
    what = f"samples{those}" if asked.each is None else f"groups by {asked.each}{those}"
    return f"{what} pass" if asked.forecast is None else f"{what} come out as {asked.forecast} says"


def _plain(value: Any) -> str:
    return str(value).lower() if isinstance(value, bool) else f"{value}"


class NoteCount(NamedTuple):
    """Samples with one value of a note.

    Attributes:
        value: in words.
        samples: how many there are.
        passed: how many of them passed.
        failed: how many failed.
        errors: how many could not be judged.
        foretold: how many of them should pass; None where nobody has said.
        kept: how many of those did; None likewise.
    """

    value: str
    samples: int
    passed: int
    failed: int
    errors: int
    foretold: int | None
    kept: int | None


def counted_by_note(rows: pa.Table, forecast: str | None, most: int) -> dict[str, list[NoteCount]]:
    """Of each note in a few words, not the same in all samples: what those with each of its values came to.

    Args:
        rows: of a sweep.
        forecast: name of the note that says whether a sample should pass, if there is one.
        most: notes with more different values are left out.
    """
    foretold = f"{NOTE}.{forecast}"
    should = rows[foretold].to_pylist() if foretold in rows.column_names else None
    verdicts = rows["verdict"].to_pylist()
    found: dict[str, list[NoteCount]] = {}
    for name in filter(is_note, rows.column_names):
        kind = rows.schema.field(name).type
        if name == foretold or not (pa.types.is_string(kind) or pa.types.is_boolean(kind)):
            continue
        values = rows[name].to_pylist()
        different = sorted({value for value in values if value is not None})
        if not 1 < len(different) <= min(most, rows.num_rows - 1) or max(map(len, map(_plain, different))) > LONGEST:
            continue
        found[name.removeprefix(f"{NOTE}.")] = [
            _note_count(value, [k for k, each in enumerate(values) if each == value], verdicts, should)
            for value in different
        ]
    return found


def _note_count(value: Any, places: list[int], verdicts: list[str], should: list[Any] | None) -> NoteCount:
    came = Counter(verdicts[k] for k in places)
    expected = None if should is None else [verdicts[k] for k in places if should[k] is True]
    return NoteCount(
        _plain(value) or "–",
        len(places),
        came["PASS"],
        came["FAIL"],
        came["ERROR"],
        None if expected is None else len(expected),
        None if expected is None else expected.count("PASS"),
    )
