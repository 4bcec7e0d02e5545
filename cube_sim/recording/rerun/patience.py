"""Pipes to and from the process that draws: whoever flies waits at them for a while, and not for ever."""

from __future__ import annotations

import os
import select

from cube_sim.uninterrupted import is_asked_to_end

TAKES_S = 10.0
"""So long nothing may be taken, or come."""
ENDS_S = 30.0
"""So long the end of a view may take: its last piece is drawn, and its file has some seconds to be written."""
HURRIED_S = 5.0
"""So long either may take at most, once somebody wants the run to end."""
_LOOK_S = 0.05


class StalledError(RuntimeError):
    """The other process stands still."""


class Patience:
    """How long is waited.

    What counts is time in which this process runs: whoever was frozen together with the other one waits anew.

    Attributes:
        hurried: whether somebody wants the run to end.
    """

    def __init__(self) -> None:
        self.hurried = False

    def send(self, pipe: int, content: bytes) -> None:
        """Write into a pipe that does not block.

        Args:
            pipe: its file descriptor.
            content: what to write.

        Raises:
            StalledError: nothing is taken any more.
            BrokenPipeError: nobody is there to take it.
        """
        left = memoryview(content)
        while left:
            self._await(pipe, select.POLLOUT, TAKES_S)
            left = left[os.write(pipe, left) :]

    def received(self, pipe: int, longest_s: float, most: int = -1) -> bytes:
        """Read from a pipe to its end.

        Args:
            pipe: its file descriptor.
            longest_s: so long nothing may come [s].
            most: so many bytes are enough; -1 for all there are.

        Raises:
            StalledError: nothing comes any more.
        """
        content = b""
        while len(content) != most:
            self._await(pipe, select.POLLIN, longest_s)
            if not (part := os.read(pipe, 65536 if most < 0 else most - len(content))):
                break
            content += part
        return content

    def _await(self, pipe: int, event: int, longest_s: float) -> None:
        poll, waited_s = select.poll(), 0.0
        poll.register(pipe, event)
        while not poll.poll(1000 * _LOOK_S):
            waited_s += _LOOK_S
            if waited_s > (min(longest_s, HURRIED_S) if self.hurried or is_asked_to_end() else longest_s):
                raise StalledError("the process that draws it stands still")
