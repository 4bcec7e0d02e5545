"""Samples flown by the workers of a Dask cluster, of which any may die on the way."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from itertools import islice
from typing import Any

from cube_sim.campaign.identity import identity_of
from cube_sim.campaign.sample_flight import FlownSample, SampleFlights, Task, died
from cube_sim.errors import CubeSimError

MISSING = "a cluster takes Dask: pip install 'cube-sim[cluster]'"
ANSWER_S = 10.0
"""So long a scheduler may take to answer [s]."""
AHEAD = 2
"""So many pieces of work wait for each thread of the cluster."""
PIECE_S = 1.0
"""About so long a piece of work takes at least [s]."""
PIECES_PER_S = 100.0
"""So many pieces are handed out in a second at most: the scheduler needs about a millisecond for each."""
MOST_IN_PIECE = 1000
DIED = "its process died, on each worker that flew it"


def on_cluster(task: Task, samples: Iterable[int], address: str) -> Iterator[FlownSample]:
    """Fly samples, in the order in which they land.

    The workers see the scenario and its files under the same names, and have the same cube_sim installed. A worker that
    dies costs nothing but time: what it flew is flown by another. A sample of which worker after worker dies is an
    ERROR.

    Args:
        task: what is flown.
        samples: their numbers.
        address: of the scheduler, tcp://host:port.

    Raises:
        CubeSimError: Dask is not installed, nobody answers, or a worker flies other code or files.
    """
    try:
        from distributed import Client, as_completed
        from distributed.scheduler import KilledWorker
    except ImportError:
        raise CubeSimError(MISSING) from None
    from cube_sim.campaign.crew import Crew, fly_piece

    identity = identity_of(task.loaded)
    try:
        client = Client(address, timeout=ANSWER_S, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        raise CubeSimError(f"--cluster {address}: no scheduler answers: {' '.join(str(error).split())}") from None
    flights, waiting = SampleFlights(task), iter(samples)
    crew = Crew(task, identity)
    pieces: dict[Any, Sequence[int]] = {}
    with client:
        try:
            client.register_plugin(crew, name=crew.name)
            landing, size = as_completed(loop=client.loop), 1

            def ask(piece: Sequence[int]) -> None:
                future = client.submit(fly_piece, crew.name, piece, pure=False)
                pieces[future] = piece
                landing.add(future)

            def threads() -> int:
                return sum(each["nthreads"] for each in client.scheduler_info(-1)["workers"].values()) or 1

            def ask_more() -> None:
                wanted = AHEAD * threads()
                while len(pieces) < wanted and (piece := tuple(islice(waiting, size))):
                    ask(piece)

            suspects: list[int] = []
            tried_alone: set[int] = set()
            ask_more()
            while pieces:
                future = next(landing)
                piece = pieces.pop(future)
                try:
                    flown: list[FlownSample] = future.result()
                except KilledWorker:
                    # What waited on a worker that died is named with what killed it: each is flown by itself again.
                    if len(piece) == 1 and piece[0] in tried_alone:
                        yield died(piece[0], DIED, "", flights.drawn(piece[0]))
                    else:
                        suspects += piece
                else:
                    yield from flown
                    spent = sum(each.wall_s for each in flown) / len(flown)
                    wanted_s = max(PIECE_S, threads() / PIECES_PER_S)
                    size = max(1, min(MOST_IN_PIECE, round(wanted_s / max(spent, 1e-3))))
                    ask_more()
                if not pieces and suspects:
                    tried_alone.add(suspects[0])
                    ask(suspects[:1])
                    del suspects[0]
        finally:
            with suppress(Exception):  # a scheduler that is gone has nothing to be told
                client.cancel(list(pieces), force=True)
                client.unregister_worker_plugin(crew.name)
