"""A sample that takes longer than it may is one ERROR row; the others are flown."""

from __future__ import annotations

import re
import time
from types import SimpleNamespace

import pytest
from support.command_line import cube_sim
from support.own_code import PID
from support.scenario_files import FLIGHT
from support.sweeps import rows_of, swept, written

from cube_sim.campaign import processes

pytestmark = pytest.mark.flight

HANGING = """\
import os

from own import pid


def law(setup):
    usual, hangs = pid(setup), setup.scenario.guidance.speed_m_s > 0.45

    def answer(aim):
        if hangs:
            open(os.environ["HANGS"], "w").close()
        while hangs:
            pass
        return usual(aim)

    return answer
"""
SPEEDS = "samples:\n  vary:\n    guidance.speed_m_s: {distribution: grid, values: [0.3, 0.5, 0.2]}\n"


LIMIT_S = 600.0
"""More than it takes to compile everything; nobody waits for it, see `swept_until_it_hangs`."""


@pytest.fixture
def swept_until_it_hangs(tmp_path, monkeypatch):
    """Sweep in processes; once one of them hangs and all the others have landed, the clock leaps beyond the limit.

    It does so a second later, when it is known that the process has come up, and every five seconds from then on.
    """
    hangs, told, since = tmp_path / "hangs", [], []
    monkeypatch.setenv("HANGS", str(hangs))

    def rows(file, others):
        def now():
            real = time.monotonic()
            if not since and told[-1].flown == others and hangs.exists():
                since.append(real)
            return real + 3.0 * LIMIT_S * ((real - since[0] + 4.0) // 5.0 if since else 0.0)

        monkeypatch.setattr(processes, "time", SimpleNamespace(monotonic=now, sleep=time.sleep))
        return rows_of(swept(file, tmp_path / "out", workers=2, limit_s=LIMIT_S, progress=told.append).folder)

    return rows


def test_a_process_that_hangs_ends_and_its_row_says_where_it_was(tmp_path, swept_until_it_hangs):
    (tmp_path / "own.py").write_text(PID)
    (tmp_path / "hang.py").write_text(HANGING)
    file = written(tmp_path, SPEEDS, FLIGHT + "control: {law: {python: 'hang.py:law'}}\n")
    rows = swept_until_it_hangs(file, 2)
    assert [row["verdict"] for row in rows] == ["PASS", "ERROR", "PASS"]
    assert rows[1]["reason"] == "not landed after 600 s of the clock, the limit of a sample"
    assert re.search(r'hang\.py", line 1[123] in answer', rows[1]["traceback"])  # where it hangs, or just before
    assert rows[1]["guidance.speed_m_s"] == 0.5


DRAWING = """\
import os


def drawn(k, rng):
    if k == 1:
        os._exit(3)
    if k == 2:
        open(os.environ["HANGS"], "w").close()
    while k == 2:
        pass
    return {"guidance.speed_m_s": 0.3}
"""


def test_a_generator_that_hangs_or_ends_its_process_costs_its_samples_only(tmp_path, swept_until_it_hangs):
    (tmp_path / "draw.py").write_text(DRAWING)
    file = written(tmp_path, "samples: {count: 4, generator: {python: 'draw.py:drawn'}}\n")
    rows = swept_until_it_hangs(file, 3)
    assert [row["verdict"] for row in rows] == ["PASS", "ERROR", "ERROR", "PASS"]
    assert rows[1]["reason"] == "its process died: exit code 3"
    assert rows[2]["reason"].startswith("not landed after 600 s")
    assert re.search(r'draw\.py", line ([89]|10) in drawn', rows[2]["traceback"])
    assert rows[3]["guidance.speed_m_s"] == 0.3


@pytest.mark.parametrize("way", ["threads", "processes"])
def test_a_compiled_flight_is_left_at_its_limit(tmp_path, way):
    long = FLIGHT.replace("duration_s: 0.5", "duration_s: 40")
    assert long != FLIGHT
    file = written(tmp_path, SPEEDS, long)
    rows = rows_of(swept(file, tmp_path / "out", workers_as=way, limit_s=1e-6).folder)
    assert [row["verdict"] for row in rows] == ["ERROR"] * 3
    assert {row["reason"] for row in rows} == {"not landed after 1e-06 s of the clock, the limit of a sample"}


def test_a_limit_is_more_than_nothing(tmp_path):
    file = written(tmp_path, SPEEDS)
    done = cube_sim("sweep", file, "--sample-timeout-s", "0", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (2, "--sample-timeout-s 0: must be greater than 0\n")
