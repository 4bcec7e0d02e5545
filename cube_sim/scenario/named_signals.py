"""Signals that checks name, held against those that there are."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from difflib import get_close_matches

from cube_sim.scenario.check_blocks import AnyCheck


def signal_mistakes(
    checks: Sequence[AnyCheck], widths: Mapping[str, int], why_absent: Callable[[str], str] = lambda _: ""
) -> Iterator[tuple[str, str]]:
    """Checks of signals, or of columns, that are none.

    Args:
        checks: of a scenario.
        widths: signal -> how many numbers a sample has, of those that are recorded.
        why_absent: why a signal is not recorded that could be, in words; "" where that is not known.

    Yields:
        Dotted path of the value at fault, and what is wrong with it.
    """
    for i, check in enumerate(checks):
        if check.named_signal is None:
            continue
        signal, component = check.named_signal
        if signal not in widths:
            if why := why_absent(signal):
                yield f"checks.{i}.signal", f"'{signal}' is not recorded: {why}"
                continue
            near = get_close_matches(signal, widths, n=1)
            hint = f"did you mean {near[0]}?" if near else f"there are {', '.join(widths)}"
            yield f"checks.{i}.signal", f"no signal '{signal}' is recorded, {hint}"
        elif component is not None and component >= widths[signal]:
            yield f"checks.{i}.component", f"{signal} has columns 0 to {widths[signal] - 1}"
