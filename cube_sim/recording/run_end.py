"""How a run ended: the last words of its record."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields
from hashlib import sha256
from json import dumps, loads
from typing import Any, Literal, get_args

from cube_sim.errors import RecordingError
from cube_sim.verdict import CheckResult, Verdict

How = Literal["completed", "stopped", "ended early", "interrupted", "failed", "recovered"]
"""All of its time was flown; a condition of the scenario's `stop` was met; it came to an end of its own before;
somebody stopped it; an error did; its record was damaged, and this is what could be saved."""

OWN_SHA256 = "sha256"


@dataclass(frozen=True)
class RunEnd:
    """How a run ended.

    Attributes:
        how: in a word.
        reason: why, where it is not "completed"; one line.
        ticks: control periods flown; None where nobody knows.
        simulated_s: simulated time from the start to the end [s]; None where nobody knows.
        given_up: why the path was given up at the end; "" where it was followed.
        verdict: of the run; None where it was not judged.
        checks: one result per check of the scenario.
        missing_s: from when to when rows are missing [s], of a recovered record.
        stop: what the condition that stopped it says, PASS or FAIL; None, and not written, where none did.
        missing_rows: how many, by channel, as far as it is known; written where there are any.
    """

    how: How
    reason: str = ""
    ticks: int | None = None
    simulated_s: float | None = None
    given_up: str = ""
    verdict: Verdict | None = None
    checks: tuple[CheckResult, ...] = ()
    missing_s: tuple[tuple[float, float], ...] = ()
    missing_rows: Mapping[str, int] = field(default_factory=dict)
    stop: Verdict | None = None

    @property
    def of_itself(self) -> bool:
        """Whether the flight came to its end, and nobody and nothing outside it stopped it."""
        return self.how in ("completed", "stopped", "ended early")


def to_texts(end: RunEnd, digests: dict[str, Any]) -> dict[str, str]:
    """The table of texts that stands in a record.

    Args:
        end: how it ended.
        digests: of what the record holds, plain data.

    Returns:
        Each attribute as JSON, `digests`, and the SHA-256 of all these.
    """
    plain = {**asdict(end), "digests": digests}
    if not end.missing_rows:
        del plain["missing_rows"]
    if end.stop is None:
        del plain["stop"]
    texts = {name: dumps(value, sort_keys=True, ensure_ascii=False) for name, value in plain.items()}
    return {**texts, OWN_SHA256: _sha256(texts)}


def from_texts(texts: dict[str, str]) -> tuple[RunEnd, dict[str, Any]]:
    """The end, and the digests, of what `to_texts` made.

    Raises:
        RecordingError: something in it is not as it was written.
    """
    rest = {name: text for name, text in texts.items() if name != OWN_SHA256}
    if texts.get(OWN_SHA256) != _sha256(rest):
        raise RecordingError("how the run ended is damaged")
    plain = {name: loads(text) for name, text in rest.items()}
    digests = plain.pop("digests")
    known = {each.name for each in fields(RunEnd)}
    if not known - {"missing_rows", "stop"} <= plain.keys() or plain["how"] not in get_args(How):
        raise RecordingError("how the run ended is told in words that this version does not know")
    plain["checks"] = tuple(CheckResult(**check) for check in plain["checks"])
    plain["missing_s"] = tuple((start, end) for start, end in plain["missing_s"])
    return RunEnd(**{name: value for name, value in plain.items() if name in known}), digests


def _sha256(texts: dict[str, str]) -> str:
    return sha256(dumps(texts, sort_keys=True, ensure_ascii=False).encode()).hexdigest()
