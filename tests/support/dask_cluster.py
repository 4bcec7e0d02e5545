"""A real Dask cluster of separate processes on this machine."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

from distributed import Client

FIRST_DEATH = {"DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "0"}
"""A scheduler gives a task up when one worker has died of it, not four."""


@contextmanager
def process(*arguments, **environment):
    """A program of Dask's."""
    command, quiet = [sys.executable, "-m", *map(str, arguments)], {"stdout": subprocess.DEVNULL}
    with subprocess.Popen(command, env=os.environ | environment, stderr=subprocess.DEVNULL, **quiet) as started:
        try:
            yield started
        finally:
            started.kill()


@contextmanager
def cluster_of(folder: Path, count: int) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """Address of a scheduler with so many workers, and their processes; nobody starts them again."""
    address = folder / "scheduler.json"
    common = ("--no-dashboard", "--scheduler-file", address)
    with ExitStack() as stack:
        stack.enter_context(process("distributed.cli.dask_scheduler", "--port", "0", *common))
        workers = [
            stack.enter_context(process("distributed.cli.dask_worker", *common, "--no-nanny", "--nthreads", "1"))
            for _ in range(count)
        ]
        client = stack.enter_context(Client(scheduler_file=str(address), timeout="60s", set_as_default=False))
        client.wait_for_workers(count, timeout=60)
        yield client.scheduler.address, workers
