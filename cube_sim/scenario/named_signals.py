"""Signals that checks name, held against those that there are."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from difflib import get_close_matches

from cube_sim.nearest import counted
from cube_sim.scenario.check_blocks import AnyCheck, ConditionCheckBlock
from cube_sim.scenario.statistic_keys import NamedSignal

_NEAREST = 3
"""Of the signals that there are, so many are named to whoever names none of them."""


def signal_mistakes(
    checks: Sequence[AnyCheck],
    widths: Mapping[str, int],
    why_absent: Callable[[str], str] = lambda _: "",
    recorded: Collection[str] | None = None,
) -> Iterator[tuple[str, str]]:
    """Checks of signals, or of columns, that are none.

    Args:
        checks: of a scenario.
        widths: signal -> how many numbers a sample has, of those that may be named.
        why_absent: why a signal is not recorded that could be, in words; "" where that is not known.
        recorded: the signals that there are, one of which may be meant; None for all that may be named.

    Yields:
        Dotted path of the value at fault, and what is wrong with it.
    """
    for i, check in enumerate(checks):
        for signal, component, place, key, beside in check.named_signals:
            where = f"checks.{i}.{place}." if place else f"checks.{i}."
            if signal not in widths:
                if why := why_absent(signal):
                    yield f"{where}{key}", f"'{signal}' is not recorded: {why}"
                    continue
                known = widths if recorded is None else recorded
                near = get_close_matches(signal, known, n=1)
                nearest = ", ".join(get_close_matches(signal, known, n=_NEAREST, cutoff=0.0)) or "none"
                hint = f"did you mean {near[0]}?" if near else f"the nearest of {len(known)} are {nearest}"
                yield f"{where}{key}", f"no signal '{signal}' is recorded, {hint}"
            elif component is not None and component >= widths[signal]:
                yield f"{where}component", f"{signal} has columns 0 to {widths[signal] - 1}"
            elif widths.get(beside, widths[signal]) != widths[signal]:
                text = f"{signal} has {counted(widths[signal], 'column')} and cannot be taken away from {beside}"
                yield f"{where}{key}", f"{text}, which has {widths[beside]}"


def unit_mistakes(checks: Sequence[AnyCheck], units: Mapping[str, Sequence[str]]) -> Iterator[tuple[str, str]]:
    """Numbers of different units that are weighed against one another, or taken away from one another.

    Args:
        checks: of a scenario.
        units: signal -> the unit of each of its numbers.

    Yields:
        Dotted path of the value at fault, and what is wrong with it.
    """
    for i, check in enumerate(checks):
        for each in check.named_signals:
            alike = len(units.get(each.signal, ())) == len(units.get(each.beside, ()))  # else that is said of it
            if each.beside and alike and units.get(each.signal) != units.get(each.beside):
                text = f"{_with_unit(each.signal, units)} cannot be taken away from {_with_unit(each.beside, units)}"
                yield f"checks.{i}.{each.place}.{each.key}" if each.place else f"checks.{i}.{each.key}", text
        if not isinstance(check, ConditionCheckBlock) or check.scaled:
            continue
        first, *others = (each for each in check.named_signals if not each.beside)
        unit = _units(first, units)
        for other in others:
            if _units(other, units) != unit:
                text = f"{_units(other, units)} beside {unit}: give every comparison a scale, by which margins compare"
                yield f"checks.{i}.{other.place}", text
                break


def _with_unit(signal: str, units: Mapping[str, Sequence[str]]) -> str:
    return f"{signal} in {', '.join(dict.fromkeys(units.get(signal, ()))) or 'no known unit'}"


def _units(named: NamedSignal, units: Mapping[str, Sequence[str]]) -> str:
    known = units.get(named.signal, ())
    chosen = known if named.component is None else known[named.component : named.component + 1]
    return ", ".join(dict.fromkeys(chosen))
