"""The unit of what a check judges."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from cube_sim.scenario.check_blocks import (
    AlwaysCheckBlock,
    AnyCheck,
    BaselineCheckBlock,
    BeforeAfterCheckBlock,
    ComparisonBlock,
    EventuallyCheckBlock,
    RatioCheckBlock,
    SignalCheckBlock,
)
from cube_sim.scenario.statistic_keys import COUNTS, SHARES, AsksStatistic

Units = Mapping[str, Sequence[str]]
"""Of each signal, the unit of each of its numbers."""

_OVER_TIME = {"W": "J", "m/s": "m", "rad/s": "rad", "N": "N s", "1": "s"}


def unit_of(check: AnyCheck, units: Units) -> str:
    """Of its value, limit and margin: "1" for a pure number, "" where nobody knows."""
    match check:
        case SignalCheckBlock():
            return unit_of_statistic(check, units)
        case AlwaysCheckBlock() | EventuallyCheckBlock():
            if check.scaled:
                return "1"
            return _joined(unit for each in check.comparisons for unit in units_of_signal(each, units))
        case RatioCheckBlock():
            above, below = unit_of_statistic(check.numerator, units), unit_of_statistic(check.denominator, units)
            return _quotient(above, below)
        case BaselineCheckBlock():
            return unit_of_statistic(check.asked or check.whole, units)
        case BeforeAfterCheckBlock():
            unit = unit_of_statistic(check, units)
            return unit if check.compare == "difference" else _quotient(unit, unit)
        case _:
            return check.unit


def unit_of_statistic(asked: AsksStatistic, units: Units) -> str:
    """Of a statistic."""
    if asked.statistic in SHARES or asked.statistic in COUNTS:
        return "1"
    if asked.statistic == "settling":
        return "s"
    unit = _joined(units_of_signal(asked, units))
    if asked.statistic == "integral" and unit:
        return _OVER_TIME.get(unit, f"({unit}) s" if ", " in unit or "/" in unit else f"{unit} s")
    return unit


def units_of_signal(asked: AsksStatistic | ComparisonBlock, units: Units) -> Sequence[str]:
    """Of each of its numbers, or of the component asked for."""
    known = units.get(asked.signal, ())
    return known if asked.component is None else known[asked.component : asked.component + 1]


def _joined(units: Iterable[str]) -> str:
    return ", ".join(dict.fromkeys(units))  # the norm of a wrench has two


def _quotient(above: str, below: str) -> str:
    if not above or not below:
        return ""
    if above == below:
        return "1"
    if below == "1":
        return above
    return f"{above}/{below}" if "/" not in below and " " not in below else f"({above})/({below})"
