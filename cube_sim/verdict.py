"""What became of a run: one result per check, one verdict for all, an early end, and their JSON form."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from typing import Any, Literal

from cube_sim.run_log import LogLine, gathered

Verdict = Literal["PASS", "FAIL", "ERROR"]
"""PASS: shown to hold. FAIL: shown not to hold. ERROR: could not be judged."""


@dataclass(frozen=True)
class CheckResult:
    """One judged check.

    Attributes:
        name: the check's name in the scenario.
        verdict: PASS, FAIL or ERROR.
        value: the worst value, in the unit of what was checked; None if it could not be judged.
        relation: how the value must compare with the limit.
        limit: the limit; its unit is the value's.
        margin: distance from value to limit, positive inside; None if it could not be judged.
        at_s: simulated time of the worst value [s]; None if it could not be judged.
        detail: one line for readers: what was compared, or why nothing could be.
        unit: of value, limit and margin, "1" for a pure number; "" where nobody knows.
    """

    name: str
    verdict: Verdict
    value: float | None
    relation: Literal["<=", ">="]
    limit: float
    margin: float | None
    at_s: float | None
    detail: str
    unit: str = ""


@dataclass(frozen=True)
class EarlyEnd:
    """That a run did not last as long as it should have.

    Attributes:
        time_s: simulated time at which it ended [s].
        reason: one line for readers.
        verdict: what such an end says by itself. ERROR: that the run shows nothing. A condition of the scenario's
            `stop` says PASS, that this is its proper end, or FAIL.
    """

    time_s: float
    reason: str
    verdict: Verdict = "ERROR"


@dataclass(frozen=True)
class Flown:
    """What a run says of itself, beside its checks.

    Attributes:
        simulated_s: simulated time from its start to its end [s]; None if it is not known.
        ended_early: when and why it ended before its time; None if it did not.
        log: what was said at the level WARNING or above, in the order of time.
    """

    simulated_s: float | None
    ended_early: EarlyEnd | None
    log: tuple[LogLine, ...]


def overall(results: Iterable[CheckResult], *, complete: bool = True, failed: bool = False) -> Verdict:
    """One verdict for a run.

    FAIL as soon as one check was shown not to hold, whatever could not be judged beside it; ERROR when none was and
    one could not be judged; PASS when every check was shown to hold.

    Args:
        results: of the checks; none at all is an ERROR.
        complete: whether the run lasted to its end. One that did not shows nothing: ERROR.
        failed: whether it ended in a way that is a failure, whatever the checks say.
    """
    verdicts = {result.verdict for result in results}
    if failed:
        return "FAIL"
    if not complete or not verdicts:
        return "ERROR"
    return next(verdict for verdict in ("FAIL", "ERROR", "PASS") if verdict in verdicts)


def to_dict(
    verdict: Verdict,
    results: Iterable[CheckResult],
    real_time_factor: float,
    versions: Mapping[str, str],
    flown: Flown | None = None,
) -> dict[str, Any]:
    """What verdict.json holds, as plain data; without `flown`, what it would say is null and its log empty."""
    flown = flown or Flown(None, None, ())
    return {
        "verdict": verdict,
        "checks": [
            {
                "name": result.name,
                "verdict": result.verdict,
                "value": result.value,
                "relation": result.relation,
                "limit": result.limit,
                "margin": result.margin,
                "unit": result.unit,
                "at_s": result.at_s,
                "detail": result.detail,
            }
            for result in results
        ],
        "simulated_s": flown.simulated_s,
        "ended_early": None if flown.ended_early is None else asdict(flown.ended_early),
        "log": [
            {
                "time_s": entry.first.t,
                "level": entry.first.level,
                "text": entry.first.text,
                "count": entry.count,
                "last_s": entry.last_s,
            }
            for entry in gathered(flown.log)
        ],
        "real_time_factor": real_time_factor,
        "versions": dict(versions),
    }


def to_json(
    verdict: Verdict,
    results: Iterable[CheckResult],
    real_time_factor: float,
    versions: Mapping[str, str],
    flown: Flown | None = None,
) -> str:
    """The text of verdict.json.

    Raises:
        ValueError: a number is NaN or infinite, which JSON cannot say.
    """
    content = to_dict(verdict, results, real_time_factor, versions, flown)
    return json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False) + "\n"
