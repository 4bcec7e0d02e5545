"""What a worker of a Dask cluster has to fly samples with; Dask is loaded with this module."""

from __future__ import annotations

from collections.abc import Sequence

from distributed import Worker
from distributed.diagnostics.plugin import WorkerPlugin

from cube_sim.campaign.identity import Identity, identity_of
from cube_sim.campaign.sample_flight import FlownSample, SampleFlights, Task
from cube_sim.errors import CubeSimError

_flights: dict[str, SampleFlights] = {}
"""Of this process, by the name of the crew."""


class Crew(WorkerPlugin):
    """Makes every worker of a cluster ready, also one that comes later.

    Args:
        task: what is flown.
        identity: of the sweep, where it was begun.
    """

    def __init__(self, task: Task, identity: Identity) -> None:
        self.name = f"cube-sim-{identity.digest}"
        self._task, self._identity = task, identity

    def setup(self, worker: Worker) -> None:
        """Load the scenario, from the worker's own files.

        Raises:
            CubeSimError: they are others, or another cube_sim is installed there.
        """
        if differences := self._identity.differences(identity_of(self._task.loaded)):
            raise CubeSimError(f"the worker {worker.address} has another {'; '.join(differences)}")
        _flights[self.name] = SampleFlights(self._task)

    def teardown(self, worker: Worker) -> None:
        """Forget it."""
        _flights.pop(self.name, None)


def fly_piece(crew: str, samples: Sequence[int]) -> list[FlownSample]:
    """On a worker: fly some samples."""
    return [_flights[crew].fly(k) for k in samples]
