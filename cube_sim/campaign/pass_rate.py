"""What a count of passes says of the rate: the bounds of Clopper and Pearson."""

from __future__ import annotations

from typing import NamedTuple

from scipy.special import betaincinv

from cube_sim.scenario.samples_block import RequiredBlock
from cube_sim.verdict import Verdict


class Interval(NamedTuple):
    """Where a rate lies.

    Attributes:
        low: lower bound.
        high: upper bound.
        confidence: of both together.
    """

    low: float
    high: float
    confidence: float


def lower_bound(passed: int, count: int, confidence: float) -> float:
    """The rate that is exceeded with a confidence, after Clopper and Pearson (Biometrika 26, 1934).

    Args:
        passed: so many passed.
        count: of so many, independent of each other.
        confidence: one-sided.
    """
    return 0.0 if passed == 0 else float(betaincinv(passed, count - passed + 1, 1.0 - confidence))


def upper_bound(passed: int, count: int, confidence: float) -> float:
    """The rate that is not reached with a confidence, likewise."""
    return 1.0 if passed == count else float(betaincinv(passed + 1, count - passed, confidence))


def interval(passed: int, count: int, confidence: float = 0.95) -> Interval:
    """Both bounds, half of what the confidence leaves beyond each."""
    one_sided = 0.5 * (1.0 + confidence)
    if count == 0:
        return Interval(0.0, 1.0, confidence)
    return Interval(lower_bound(passed, count, one_sided), upper_bound(passed, count, one_sided), confidence)


def least_count(pass_rate: float, confidence: float, failed: int = 0) -> int:
    """How many samples show a pass rate at a confidence where so many of them fail."""
    low, high = failed + 1, failed + 1
    while lower_bound(high - failed, high, confidence) < pass_rate:
        low, high = high, 2 * high
    while low < high:
        middle = (low + high) // 2
        if lower_bound(middle - failed, middle, confidence) >= pass_rate:
            high = middle
        else:
            low = middle + 1
    return low


class RateJudged(NamedTuple):
    """Whether samples show what they must.

    Attributes:
        verdict: PASS where they show it, FAIL where they show the contrary, ERROR where they are too few for either.
        detail: one line for readers.
    """

    verdict: Verdict
    detail: str


def judged(
    passed: int, failed: int, errors: int, required: RequiredBlock | None, words: str = "samples pass"
) -> RateJudged:
    """Judge a sweep: what could not be judged has not passed.

    Args:
        passed: how many samples passed.
        failed: how many failed.
        errors: how many could not be judged.
        required: the rate they must show; None, or none in it: every one must pass.
        words: what is counted, and what those that passed did.
    """
    count = passed + failed + errors
    if count == 0:
        return RateJudged("ERROR", "no sample is flown" if words == "samples pass" else f"0 of 0 {words}")
    if required is None or required.pass_rate is None:
        verdict = "FAIL" if failed else "ERROR" if errors else "PASS"
        return RateJudged(verdict, f"{passed} of {count} {words}, all of them wanted")
    rate, confidence = required.pass_rate, required.confidence
    low, high = lower_bound(passed, count, confidence), upper_bound(passed, count, confidence)
    said = f"{passed} of {count} {words}"
    if low >= rate:
        return RateJudged("PASS", f"{said}: a pass rate above {low:.4f} at {confidence:g} confidence, {rate:g} wanted")
    if high < rate:
        return RateJudged("FAIL", f"{said}: a pass rate below {high:.4f} at {confidence:g} confidence, {rate:g} wanted")
    more = least_count(rate, confidence, count - passed)
    enough = f"{more} samples with no more that fail would" if more > count else "more samples would"
    text = f"{said}: a pass rate above {low:.4f} at {confidence:g} confidence, too few to show {rate:g}; {enough}"
    return RateJudged("ERROR", text)
