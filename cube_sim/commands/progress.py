"""Progress bars on the terminal while a command works; they vanish when it is done."""

from __future__ import annotations

import contextlib
import sys
import time
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING

from cube_sim.commands.leaving import raise_on_interrupt

if TYPE_CHECKING:
    from rich.progress import Progress

    from cube_sim.campaign.sweep import HowFar

COMPILES = "compiling for this machine, once after an installation or an update: about a minute"


def begin_compiling(*, hidden: bool) -> None:
    """Begin to make the machine code of a flight where there is none yet, and say so.

    Args:
        hidden: whether nothing is said.
    """
    from cube_sim.flight.compiled import compile_beside

    if compile_beside() and not hidden:
        print(COMPILES, file=sys.stderr, flush=True)


@contextlib.contextmanager
def flight_progress(name: str, duration_s: float, *, hidden: bool) -> Iterator[Callable[[float, float], None]]:
    """A bar while a run lasts; from its first report on Ctrl-C is the usual exception.

    Args:
        name: of the scenario.
        duration_s: whole simulated time [s].
        hidden: whether nothing is shown; nor is it where stderr is no terminal.

    Yields:
        What the run calls with (simulated, whole) seconds.
    """
    with _bar("{task.completed:.0f} of {task.total:.0f} s simulated", hidden=hidden) as bar:
        task = None if bar is None else bar.add_task(name, total=duration_s, pace="", more="")
        started: float | None = None

        def update(simulated_s: float, whole_s: float) -> None:
            nonlocal started
            raise_on_interrupt()
            if bar is None or task is None:
                return
            now = time.perf_counter()
            if started is None:
                # The first report: loading and compiling are over, nothing has moved yet.
                started = now
            factor = f"{simulated_s / (now - started):.1f} x real time" if simulated_s > 0 and now > started else ""
            bar.update(task, completed=simulated_s, total=whole_s, pace=factor)

        yield update


@contextlib.contextmanager
def sweep_progress(name: str, *, hidden: bool) -> Iterator[Callable[[HowFar], None]]:
    """A bar while a sweep lasts, by what is in its files; from its first report on Ctrl-C is the usual exception.

    Args:
        name: of the scenario.
        hidden: whether nothing is shown; nor is it where stderr is no terminal.

    Yields:
        What the sweep tells how far it is.
    """
    with _bar("{task.completed:.0f} of {task.total:.0f} samples stored", hidden=hidden) as bar:
        task = None if bar is None else bar.add_task(name, total=None, pace="", more="")
        begun: tuple[float, int] | None = None

        def update(told: HowFar) -> None:
            nonlocal begun
            raise_on_interrupt()
            if bar is None or task is None:
                return
            now = time.perf_counter()
            begun = begun or (now, told.flown)
            flown, seconds = told.flown - begun[1], now - begun[0]
            rate = f"{flown / seconds:.1f} a second" if flown and seconds > 0.0 else ""
            failed = f"{told.failed} did not pass" if told.failed else ""
            bar.update(task, completed=told.stored, total=told.wanted, pace=rate, more=failed)

        yield update


@contextlib.contextmanager
def loss_progress(*, hidden: bool) -> Iterator[Callable[[int, int], None] | None]:
    """A bar while losses of thrusters are tabulated.

    Args:
        hidden: whether nothing is shown; nor is it where stderr is no terminal.

    Yields:
        What is called with (cases done, all cases); None when nothing is shown.
    """
    with _bar("{task.completed:.0f} of {task.total:.0f}", hidden=hidden) as bar:
        if bar is None:
            yield None
            return
        task = bar.add_task("lost thrusters", total=None, pace="", more="")
        yield lambda done, total: bar.update(task, completed=done, total=total)


@contextlib.contextmanager
def _bar(counted: str, *, hidden: bool) -> Iterator[Progress | None]:
    """A bar on stderr that vanishes, with the fields `pace` and `more`; None where nothing is to be shown.

    Args:
        counted: how far its task is, as a format of rich.
        hidden: whether nothing is shown; nor is it where stderr is no terminal.
    """
    if hidden or not sys.stderr.isatty():
        yield None
        return
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        TextColumn(counted),
        TextColumn("{task.fields[pace]}", markup=False),
        TextColumn("{task.fields[more]}", markup=False),
        TimeRemainingColumn(),
    )
    with Progress(*columns, console=Console(stderr=True), transient=True) as bar:
        yield bar
