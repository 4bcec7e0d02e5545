"""The exceptions cube_sim raises on purpose; each carries what a caller needs to mend the cause."""

from __future__ import annotations

from pathlib import Path
from signal import SIGINT
from traceback import extract_tb

from cube_sim.run_log import LogLine
from cube_sim.uninterrupted import interrupted_by, signal_of


class CubeSimError(Exception):
    """Root of every deliberate error; its text is one clear line per mistake."""


class ModelError(CubeSimError):
    """An MJCF model cannot be given water.

    Attributes:
        element: name of the MJCF element at fault, e.g. ``hull:added_mass``.
        reason: what is wrong and what would be right.
        model: path of the model, or "" when it was built in memory.
        place: ``file:line:column`` of the element, or "" where none is known.
    """

    def __init__(self, element: str, reason: str, model: str = "", place: str = "") -> None:
        self.element, self.reason, self.model, self.place = element, reason, model, place
        super().__init__(": ".join(part for part in (place or model, element, reason) if part))


class ShapeError(CubeSimError):
    """A file of a hull's shape, of its thrusters or the like cannot be used; the text begins with file:line."""


class ScenarioError(CubeSimError):
    """A scenario file cannot be run.

    Attributes:
        mistakes: one ``file:line:column: path: message`` line per mistake, in file order.
    """

    def __init__(self, mistakes: list[str]) -> None:
        self.mistakes = mistakes
        super().__init__("\n".join(mistakes))


class OwnCodeError(CubeSimError):
    """Code of the user's own raised, or its answer is none.

    Attributes:
        key: dotted path of the scenario's value that names it.
        reason: what, and the line of that code: ``pid.py:7: ZeroDivisionError: division by zero``.
    """

    def __init__(self, key: str, reason: str) -> None:
        self.key, self.reason = key, reason
        super().__init__(f"{key}: {reason}")


class FlightError(CubeSimError):
    """A flight was stepped, reset or restored with something that makes no sense."""


class PathError(CubeSimError):
    """A path's description makes no path: points that coincide, corners that do not fit.

    Attributes:
        below: keys and indices of the value at fault within the description, () when it is the whole.
    """

    def __init__(self, message: str, *below: str | int) -> None:
        self.below = below
        super().__init__(message)


class ActuationError(CubeSimError):
    """An actuation matrix, limits or lost thrusters that mean nothing (wrong shape, NaN, no such thruster)."""


class AllocationError(CubeSimError):
    """An allocator was built from a matrix or limits that mean nothing (crossed limits, NaN, wrong shape)."""


class WrenchError(ActuationError, AllocationError):
    """A matrix, limits, names or numbers that mean nothing to the analysis and to an allocator alike.

    It is both of their errors, because both read the same matrix and the same limits by the same checks.
    """


class RecordingError(CubeSimError):
    """A recording cannot be written or read."""


class SweepError(CubeSimError):
    """A sweep cannot go on; what is flown stays."""


class UnknownSignalError(RecordingError, KeyError):
    """No such signal was recorded; a KeyError too, as of any mapping."""

    def __str__(self) -> str:
        """The text without the quotes that a KeyError puts around it."""
        return str(self.args[0])


class DirectoryError(RecordingError):
    """A folder cannot take a recording; nothing was written."""


class RunInterrupted(KeyboardInterrupt):
    """Ctrl-C during a flight, SIGTERM or SIGHUP.

    Attributes:
        directory: where the recording of what was flown is, closed and readable, if there is one.
        log: what had been said at the level WARNING or above, in the order of time.
        number: of the signal.
    """

    def __init__(
        self,
        directory: Path,
        log: tuple[LogLine, ...] = (),
        recorded: bool = True,
        number: int = SIGINT,
        judged: bool = False,
    ) -> None:
        """Tell what was interrupted.

        Args:
            directory: where what was flown is.
            log: what had been said.
            recorded: whether it is recorded.
            number: of the signal.
            judged: whether the flight had come to its own end, and its verdict is written.
        """
        self.directory, self.log, self.number = directory, log, number
        said = interrupted_by(number)
        if judged:
            said = f"{said} once the run was over; it is whole, and judged: {directory}"
        elif recorded:
            said = f"{said}; recorded so far: {directory}"
        super().__init__(said)


class SweepInterrupted(KeyboardInterrupt):
    """Ctrl-C during a sweep, SIGTERM or SIGHUP.

    Attributes:
        directory: where the rows of what was flown are.
        stored: so many samples are there.
        number: of the signal.
    """

    def __init__(self, directory: Path, stored: int, wanted: int, interrupt: KeyboardInterrupt) -> None:
        """Tell what was interrupted.

        Args:
            directory: where the rows are.
            stored: of so many samples.
            wanted: of so many in all.
            interrupt: the signal.
        """
        self.directory, self.stored, self.number = directory, stored, signal_of(interrupt)
        super().__init__(f"{interrupted_by(self.number)}: {stored} of {wanted} samples are in {directory}")


def told(error: Exception) -> str:
    """An error in one line: its own, the system's, or of one that nobody foresaw the line of code as well."""
    if isinstance(error, OSError) and error.strerror:
        return error.strerror
    said = " ".join(str(error).split())
    if isinstance(error, CubeSimError):
        return said
    places = extract_tb(error.__traceback__)
    where = f"{Path(places[-1].filename).name}:{places[-1].lineno}: " if places else ""
    return f"{where}{type(error).__name__}: {said}"
