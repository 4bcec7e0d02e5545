"""A sweep on a real Dask cluster of separate processes on this machine."""

from __future__ import annotations

import signal
from contextlib import ExitStack

import pytest
from distributed import Client
from support.command_line import call
from support.dask_cluster import FIRST_DEATH, cluster_of, process
from support.own_code import PID
from support.scenario_files import FLIGHT
from support.sweeps import rows_of, swept, written

from cube_sim.campaign import cluster, identity
from cube_sim.errors import CubeSimError

pytestmark = pytest.mark.flight

SAMPLES = """\
samples:
  count: 24
  vary:
    current_m_s: {distribution: direction, high: 0.3}
  lost_thrusters: {losses: [0, 1], choose: random, at_s: 5}
"""


@pytest.fixture
def dask(tmp_path):
    """A scheduler with two workers."""
    with cluster_of(tmp_path, 2) as found:
        yield found


def test_one_worker_killed_on_the_way_changes_no_byte(dask, tmp_path, monkeypatch):
    address, workers = dask
    monkeypatch.setattr(cluster, "PIECE_S", 0.3)
    file = written(tmp_path, SAMPLES, FLIGHT.replace("duration_s: 0.5", "duration_s: 10"))
    flown, killed = [], []

    def told(how_far):
        flown.append(how_far.flown)
        if how_far.flown >= 6 and not killed:
            killed.append(how_far.flown)
            workers[0].send_signal(signal.SIGKILL)

    swept(file, tmp_path / "cluster", cluster=address, progress=told)
    assert workers[0].wait() == -signal.SIGKILL
    assert killed[0] < 24 == flown[-1]
    assert flown == sorted(set(flown))
    swept(file, tmp_path / "threads", workers=2)
    assert (tmp_path / "cluster" / "rows.parquet").read_bytes() == (tmp_path / "threads" / "rows.parquet").read_bytes()


def test_a_worker_that_comes_later_flies_too(dask, tmp_path):
    address, workers = dask
    workers[1].kill()
    file = written(tmp_path, SAMPLES.replace("24", "16"), FLIGHT.replace("duration_s: 0.5", "duration_s: 10"))
    late = ("distributed.cli.dask_worker", address, "--no-nanny", "--nthreads", "2", "--no-dashboard", "--name", "late")
    with ExitStack() as stack:

        def told(how_far):
            if how_far.flown == 4:
                workers[0].kill()  # the last: from now on nobody flies
                stack.enter_context(process(*late))

        swept(file, tmp_path / "cluster", cluster=address, progress=told)
    swept(file, tmp_path / "threads")
    assert rows_of(tmp_path / "cluster") == rows_of(tmp_path / "threads")


def test_what_kills_every_worker_is_a_row(tmp_path):
    """Its worker is started again by a nanny; what waited there is flown, and what it died of is given up."""
    (tmp_path / "own.py").write_text(PID)
    (tmp_path / "kill.py").write_text(
        "import os, signal\nfrom own import pid\n\n\ndef law(setup):\n"
        "    if setup.scenario.guidance.speed_m_s > 0.5:\n        os.kill(os.getpid(), signal.SIGKILL)\n"
        "    return pid(setup)\n"
    )
    samples = "samples:\n  vary:\n    guidance.speed_m_s: {distribution: grid, values: [0.3, 0.6, 0.2]}\n"
    file = written(tmp_path, samples, FLIGHT + "control: {law: {python: 'kill.py:law'}}\n")
    address = tmp_path / "scheduler.json"
    common = ("--no-dashboard", "--scheduler-file", address)
    with ExitStack() as stack:
        stack.enter_context(process("distributed.cli.dask_scheduler", "--port", "0", *common, **FIRST_DEATH))
        stack.enter_context(process("distributed.cli.dask_worker", "--nthreads", "1", *common))
        client = stack.enter_context(Client(scheduler_file=str(address), timeout="60s", set_as_default=False))
        client.wait_for_workers(1, timeout=60)
        swept(file, tmp_path / "out", cluster=client.scheduler.address)
    rows = rows_of(tmp_path / "out")
    assert [row["verdict"] for row in rows] == ["PASS", "ERROR", "PASS"]
    assert rows[1]["reason"] == cluster.DIED
    assert rows[1]["guidance.speed_m_s"] == 0.6


def test_workers_that_have_other_files_are_refused(dask, tmp_path, monkeypatch):
    address, _ = dask
    file = written(tmp_path, SAMPLES.replace("at_s: 5", "at_s: 0.1"))
    before = identity.versions()
    monkeypatch.setattr(identity, "versions", lambda: {**before, "mujoco": "0.0.1"})
    with pytest.raises(CubeSimError, match=r"has another version of mujoco"):
        swept(file, tmp_path / "out", cluster=address)


def test_nobody_there_is_told(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(cluster, "ANSWER_S", 0.5)
    file = written(tmp_path, SAMPLES.replace("at_s: 5", "at_s: 0.1"))
    code, _, said = call(
        monkeypatch, capsys, "sweep", file, "--out", tmp_path / "out", "--cluster", "tcp://127.0.0.1:1"
    )
    assert code == 3
    assert said.startswith("--cluster tcp://127.0.0.1:1: no scheduler answers: ")
    assert len(said.splitlines()) == 1
