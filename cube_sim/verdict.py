"""What became of a run: one result per check, one verdict for all, and their JSON form."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

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
    """

    name: str
    verdict: Verdict
    value: float | None
    relation: Literal["<=", ">="]
    limit: float
    margin: float | None
    at_s: float | None
    detail: str


def overall(results: Iterable[CheckResult], *, complete: bool = True) -> Verdict:
    """One verdict for a run.

    FAIL as soon as one check was shown not to hold, whatever could not be judged beside it; ERROR when none was and
    one could not be judged; PASS when every check was shown to hold.

    Args:
        results: of the checks; none at all is an ERROR.
        complete: whether the run lasted to its end. One that did not shows nothing: ERROR.
    """
    verdicts = {result.verdict for result in results}
    if not complete or not verdicts:
        return "ERROR"
    return next(verdict for verdict in ("FAIL", "ERROR", "PASS") if verdict in verdicts)


def to_dict(
    verdict: Verdict, results: Iterable[CheckResult], real_time_factor: float, versions: Mapping[str, str]
) -> dict[str, Any]:
    """What verdict.json holds, as plain data."""
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
                "at_s": result.at_s,
                "detail": result.detail,
            }
            for result in results
        ],
        "real_time_factor": real_time_factor,
        "versions": dict(versions),
    }


def to_json(
    verdict: Verdict, results: Iterable[CheckResult], real_time_factor: float, versions: Mapping[str, str]
) -> str:
    """The text of verdict.json.

    Raises:
        ValueError: a number is NaN or infinite, which JSON cannot say.
    """
    content = to_dict(verdict, results, real_time_factor, versions)
    return json.dumps(content, indent=2, ensure_ascii=False, allow_nan=False) + "\n"
