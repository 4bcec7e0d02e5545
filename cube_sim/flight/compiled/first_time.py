"""The first flight on a machine, or after an update: everything has to be compiled.

Whoever flies compiles as little of it as can be: the compiler needs more memory than a flight, and keeps it.
"""

from __future__ import annotations

from functools import cache

from cube_sim.allocation.exact.code import SEARCH, SEARCHING
from cube_sim.allocation.subset_qp.confirmer import CONFIRMATION
from cube_sim.control.answering import WANTING
from cube_sim.control.compiled_parts import ATTITUDE
from cube_sim.flight.compiled.binding import compile_loop
from cube_sim.flight.compiled.callees import ANSWERING
from cube_sim.flight.compiled.loop import fly
from cube_sim.flight.compiled.steering import LAW
from cube_sim.mission import prepare
from cube_sim.mission.surface_watch import SurfaceWatch
from cube_sim.native import apart
from cube_sim.native.compiled import on_disk
from cube_sim.recording.signal_store import SignalStore
from cube_sim.scenario import load
from cube_sim.shipped import shipped_root

LOOP = f"{__name__}:make_loop"
"""What compiles the loop and the water, for `cube_sim.native.apart`."""


@cache
def compile_beside() -> bool:
    """Whether there is not all of the machine code yet; other processes then begin to make what there is not."""
    there = {LOOP: on_disk(fly), SEARCH: SEARCHING.on_disk, ATTITUDE: WANTING.on_disk, LAW: ANSWERING.on_disk}
    missing = [part for part, made in there.items() if not made]
    if missing:
        apart.begin(*missing, CONFIRMATION)
    return bool(missing)


def wait_for_loop() -> None:
    """Until another process has made what a mission begins with, if one does; the rest may take longer."""
    apart.finish(LOOP)


def make_loop() -> None:
    """Compile the loop, and on the way to it the water and what else a mission is prepared with."""
    from cube_sim.flight.start import described  # it has a mission prepared by whoever is waiting for this

    mission = prepare(load(shipped_root() / "scenarios" / "cube_helix.yaml"))
    store = SignalStore(mission.channels)
    described(mission, store)
    compile_loop(mission, SurfaceWatch(store, mission.model, mission.vehicle).boxes)
