"""The parts of a view, each drawn for itself: one that cannot be drawn is left out and told, and the others stay."""

from __future__ import annotations

from collections.abc import Callable

import rerun as rr

from cube_sim.recording.rerun.places import Places

_ITS_OWN = (ArithmeticError, LookupError, TypeError, ValueError)
"""What drawing raises over what is drawn. A place that cannot be written raises others, and costs the whole view."""


class Parts:
    """Draws parts of a view by their names, and no more of one that could not be drawn.

    Attributes:
        left_out: name -> why it is not drawn, in one line.
    """

    def __init__(self, recording: rr.RecordingStream, places: Places) -> None:
        """Say in this recording, below the log of these places, what is not drawn."""
        self._recording, self._places = recording, places
        self.left_out: dict[str, str] = {}

    def draw(self, name: str, draw: Callable[[], None]) -> None:
        """Draw a part, or some more of it."""
        if name in self.left_out:
            return
        try:
            draw()
        except _ITS_OWN as error:
            self.leave_out(name, " ".join(str(error).split()) or type(error).__name__)

    def leave_out(self, name: str, reason: str) -> None:
        """Draw nothing of a part from now on, and say why."""
        self.left_out[name] = reason
        # Beside the log and not in it: what is static hides what comes later.
        message = rr.TextLog(f"{name} is not drawn: {reason}", level="WARN")
        place = rr.escape_entity_path_part(name)
        self._recording.log(f"{self._places.log}/model/{place}", message, static=True)
