"""Many ticks of a flight in one compiled call, over the same stages as the loop in Python."""

from cube_sim.flight.compiled.binding import FlownTicks, engine_of, fly_ticks
from cube_sim.flight.compiled.first_time import compile_beside
from cube_sim.flight.compiled.loop import BEGIN, ESTIMATED, JUDGED

__all__ = ["BEGIN", "ESTIMATED", "JUDGED", "FlownTicks", "compile_beside", "engine_of", "fly_ticks"]
