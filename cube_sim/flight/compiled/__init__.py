"""Many ticks of a flight in one compiled call, over the same stages as the loop in Python."""

from cube_sim.flight.compiled.binding import begin_ticks, engine_of, is_classical
from cube_sim.flight.compiled.first_time import compile_beside, wait_for_loop
from cube_sim.flight.compiled.loop import BEGIN, ESTIMATED, FAILED, FORWARDED, JUDGED, STOPPED, TICKED, UNANSWERED
from cube_sim.flight.compiled.stretch import FlownTicks, Stretch

__all__ = [
    "BEGIN",
    "ESTIMATED",
    "FAILED",
    "FORWARDED",
    "JUDGED",
    "STOPPED",
    "TICKED",
    "UNANSWERED",
    "FlownTicks",
    "Stretch",
    "begin_ticks",
    "compile_beside",
    "engine_of",
    "is_classical",
    "wait_for_loop",
]
