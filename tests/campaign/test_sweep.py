"""Sweeps: the same rows whoever flies them, nothing lost, nothing flown twice, what crashes is a row."""

from __future__ import annotations

import json
import os
import re
import signal
import time

import pyarrow.parquet as pq
import pytest
from support.command_line import call, cube_sim, started
from support.own_code import PID
from support.scenario_files import FLIGHT
from support.sweeps import SAMPLES, rows_of, swept, written

from cube_sim.campaign import sampling
from cube_sim.campaign import sweep as campaign
from cube_sim.campaign.folder import Shard
from cube_sim.errors import CubeSimError, DirectoryError, ScenarioError, SweepError
from cube_sim.runs.recorded_run import load_run
from cube_sim.scenario import load
from cube_sim.simulation import fly

pytestmark = pytest.mark.flight

CRASHING = """\
import os
import signal
from own import pid


def law(setup):
    speed = setup.scenario.guidance.speed_m_s
    if speed > 0.55:
        os.kill(os.getpid(), signal.SIGSEGV)
    if speed > 0.5:
        raise SystemError("nobody foresaw this")
    usual, calls = pid(setup), []

    def answer(aim):
        calls.append(1)
        return usual(None if speed > 0.45 and len(calls) == 10 else aim)

    return answer
"""


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    """A scenario file and its sweep, flown on one thread."""
    folder = tmp_path_factory.mktemp("flown")
    file = written(folder)
    return file, swept(file, folder / "out", workers=1)


def test_a_row_is_what_the_sample_comes_to_when_it_is_flown_alone(flown, tmp_path):
    file, result = flown
    rows = rows_of(result.folder)
    assert [row["sample"] for row in rows] == list(range(12))
    assert {row["verdict"] for row in rows} == {"PASS", "FAIL"}
    for k in (0, 5, 11):
        loaded = sampling.sample(load(file), k)
        alone, row = fly(loaded, out=tmp_path / str(k), record="none"), rows[k]
        assert (row["verdict"], row["seed"]) == (alone.verdict, loaded.scenario.seed)
        assert row["guidance.speed_m_s"] == loaded.scenario.guidance.speed_m_s
        assert row["lost_thrusters"] == "+".join(sampling.variation(load(file), k)["lost_thrusters"])
        for check in alone.checks:
            name = f"check.{check.name}"
            assert (row[f"{name}.value"], row[f"{name}.margin"]) == (check.value, check.margin)
            assert (row[f"{name}.verdict"], row[f"{name}.at_s"]) == (check.verdict, check.at_s)
    failed = next(row for row in rows if row["verdict"] == "FAIL")
    assert failed["reason"].startswith("max of path_error.cross_track: 0.")


@pytest.mark.parametrize("way", [{"workers": 3}, {"workers": 2, "workers_as": "processes"}])
def test_the_rows_are_the_same_bytes_whoever_flies(flown, tmp_path, way):
    file, result = flown
    other = swept(file, tmp_path / "out", **way)
    for name in ("rows.parquet", "sweep.json"):
        assert (other.folder / name).read_bytes() == (result.folder / name).read_bytes()
    assert sorted(each.name for each in other.folder.iterdir()) == ["rows.parquet", "sweep.json", "times.parquet"]
    times = pq.read_table(other.folder / "times.parquet").to_pylist()
    assert all(0.0 < each["flight_s"] < each["wall_s"] for each in times)


def test_parts_of_a_sweep_are_the_sweep(flown, tmp_path):
    file, result = flown
    for number in (1, 2, 3):
        part = swept(file, tmp_path / "out", shard=Shard(number, 3), workers=2)
        assert part.rows["sample"].to_pylist() == list(range(number - 1, 12, 3))
    whole = swept(file, tmp_path / "out", resume=True)
    assert (whole.folder / "rows.parquet").read_bytes() == (result.folder / "rows.parquet").read_bytes()
    assert whole.verdict == result.verdict


def test_more_samples_of_the_same(flown, tmp_path, monkeypatch):
    file, result = flown
    few = load(file, {"samples.count": 5})
    campaign.sweep(few, tmp_path / "out")
    asked = []
    usual = campaign.on_threads
    monkeypatch.setattr(
        campaign, "on_threads", lambda task, samples, n: asked.append(samples) or usual(task, samples, n)
    )
    whole = swept(file, tmp_path / "out", resume=True)
    assert asked == [list(range(5, 12))]
    assert (whole.folder / "rows.parquet").read_bytes() == (result.folder / "rows.parquet").read_bytes()


def test_another_scenario_or_other_code_is_not_gone_on_with(tmp_path):
    file = written(tmp_path)
    campaign.sweep(load(file, {"samples.count": 2}), tmp_path / "out")
    written(tmp_path, before=FLIGHT.replace("0.05", "0.06"))
    with pytest.raises(DirectoryError, match="holds another sweep; what differs: scenario; give a new folder"):
        swept(file, tmp_path / "out", resume=True)
    (tmp_path / "draw.py").write_text("def draw(k, rng):\n    return {}\n")
    file = written(tmp_path, "samples: {count: 2, generator: {python: 'draw.py:draw'}}\n", name="own.yaml")
    swept(file, tmp_path / "own", workers_as="threads")
    (tmp_path / "draw.py").write_text("def draw(k, rng):\n    return {'guidance.speed_m_s': 0.3}\n")
    with pytest.raises(DirectoryError, match=r"holds another sweep; what differs: file samples.generator: draw.py"):
        swept(file, tmp_path / "own", resume=True)


def test_failures_are_kept_and_are_what_the_row_says(flown, tmp_path):
    file, result = flown
    kept = swept(file, tmp_path / "out", keep="failures", workers=2)
    assert (kept.folder / "rows.parquet").read_bytes() == (result.folder / "rows.parquet").read_bytes()
    failed = [row for row in rows_of(kept.folder) if row["verdict"] != "PASS"]
    assert {int(each.name) for each in (kept.folder / "runs").iterdir()} == {row["sample"] for row in failed} != set()
    for row in failed:
        run = load_run(kept.folder / "runs" / str(row["sample"]))
        assert run.checks[0].value == row["check.max of path_error.cross_track.value"]


def test_what_crashes_is_one_row(tmp_path):
    """Its own code may raise as it is made, as it flies, or take its process with it."""
    (tmp_path / "own.py").write_text(PID)
    (tmp_path / "crash.py").write_text(CRASHING)
    samples = "samples:\n  vary:\n    guidance.speed_m_s: {distribution: grid, values: [0.3, 0.48, 0.52, 0.58, 0.2]}\n"
    file = written(tmp_path, samples, FLIGHT + "control: {law: {python: 'crash.py:law'}}\n")
    result = swept(file, tmp_path / "out", workers=2)
    rows = rows_of(result.folder)
    assert [row["verdict"] for row in rows] == ["PASS", "ERROR", "ERROR", "ERROR", "PASS"]
    assert rows[1]["reason"].startswith("ended at 0.")
    assert "crash.py:16: AttributeError" in rows[1]["reason"]
    assert 'crash.py", line 16, in answer' in rows[1]["traceback"]
    assert 'own.py", line' in rows[1]["traceback"]
    assert rows[1]["traceback"].rstrip().splitlines()[-1].startswith("AttributeError: ")
    assert "campaign" not in rows[1]["traceback"]
    assert "SystemError: nobody foresaw this" in rows[2]["reason"]
    assert rows[3]["reason"] == "its process died: SIGSEGV"
    assert 'crash.py", line 9 in law' in rows[3]["traceback"]
    assert rows[3]["guidance.speed_m_s"] == 0.58
    assert rows[0]["traceback"] is None
    assert result.verdict is not None
    assert result.verdict.verdict == "ERROR"


def test_an_error_nobody_foresaw_has_its_traceback_whoever_flies(tmp_path):
    (tmp_path / "draw.py").write_text(
        "def draw(k, rng):\n    return {'guidance.speed_m_s': 0.3 if k != 1 else object}\n"
    )
    file = written(tmp_path, "samples: {count: 3, generator: {python: 'draw.py:draw'}}\n")
    for name in ("threads", "processes"):
        swept(file, tmp_path / name, workers_as=name)
    rows = rows_of(tmp_path / "threads")
    assert [row["verdict"] for row in rows] == ["PASS", "ERROR", "PASS"]
    assert (tmp_path / "threads" / "rows.parquet").read_bytes() == (
        tmp_path / "processes" / "rows.parquet"
    ).read_bytes()


def test_what_a_proper_end_leaves_unjudged_is_the_reason(tmp_path):
    legs = "waypoints: [{to_m: [9, 0, -5]}, {name: back, to_m: [0, 0, -5]}]\n"
    ending = "stop: [{kind: signal, signal: pose.position, component: 0, above: 0.002, verdict: pass}]\n"
    check = (
        "  - {kind: signal, name: way back, signal: path_error.cross_track, statistic: max, phase: back, at_most: 5}\n"
    )
    path = "path: {type: line, start_m: [0, 0, -5], end_m: [4, 0, -5]}\n"
    assert path in FLIGHT
    file = written(tmp_path, ending + "samples: {count: 1}\n", FLIGHT.replace(path, legs) + check)
    (row,) = rows_of(swept(file, tmp_path / "out").folder)
    assert row["verdict"] == "ERROR"
    assert re.fullmatch(r"way back: phase 'back' was never entered; ended at .* s: .*above 0.002", row["reason"])


def test_a_process_that_does_not_come_up_is_told(tmp_path, monkeypatch):
    file = written(tmp_path, "samples: {count: 3}\n")
    monkeypatch.setenv("PYTHONHOME", "/nowhere")
    with pytest.raises(CubeSimError, match="a process to fly in does not come up"):
        swept(file, tmp_path / "out", workers=1, workers_as="processes")


def test_what_the_vehicle_refuses_is_refused_before_a_folder_is_made(tmp_path):
    file = written(tmp_path, SAMPLES.replace("losses: [0, 1, 2]", "losses: [9]"))
    with pytest.raises(ScenarioError, match=r"samples.lost_thrusters.losses: must be at most 8"):
        swept(file, tmp_path / "out")
    assert not (tmp_path / "out").exists()


SLOW = """\
samples:
  count: 200
  vary:
    current_m_s.1: {distribution: uniform, low: 0, high: 0.1}
"""


@pytest.fixture
def slow(tmp_path):
    """A sweep that takes some seconds."""
    return written(tmp_path, SLOW, FLIGHT.replace("duration_s: 0.5", "duration_s: 20"))


def wait_for_rows(folder, process):
    for _ in range(1200):
        if [*folder.glob("parts/part*.parquet")]:
            return
        assert process.poll() is None, process.communicate()
        time.sleep(0.05)
    raise TimeoutError("no rows come")


@pytest.mark.parametrize("way", ["threads", "processes"])
def test_a_kill_loses_nothing_that_is_stored(slow, tmp_path, way):
    arguments = ("sweep", slow, "--out", "out", "--set", "samples.count=60", "--workers-as", way)
    with started(*arguments, cwd=tmp_path) as process:
        wait_for_rows(tmp_path / "out", process)
        process.send_signal(signal.SIGKILL)
        process.wait()
    stored = {file.name: file.read_bytes() for file in (tmp_path / "out" / "parts").iterdir()}
    assert stored
    assert not (tmp_path / "out" / "rows.parquet").exists()
    done = cube_sim(*arguments, "--resume", "--json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["pass"] == 60
    whole = campaign.sweep(load(slow, {"samples.count": 60}), tmp_path / "whole")
    assert (tmp_path / "out" / "rows.parquet").read_bytes() == (whole.folder / "rows.parquet").read_bytes()


@pytest.mark.parametrize("way", ["threads", "processes"])
def test_ctrl_c_keeps_what_is_flown(slow, tmp_path, way):
    asked = ("--workers-as", way, "--keep", "failures", "--sample-timeout-s", "100")
    with started("sweep", slow, "--out", "out", *asked, cwd=tmp_path) as process:
        wait_for_rows(tmp_path / "out", process)
        process.send_signal(signal.SIGINT)
        _, said = process.communicate(timeout=60)
    assert process.returncode == 130
    first, then = said.strip().splitlines()[-2:]
    count = len(
        [k for file in (tmp_path / "out" / "parts").iterdir() for k in pq.read_table(file)["sample"].to_pylist()]
    )
    assert first == f"interrupted: {count} of 200 samples are in out"
    assert then == f"go on with: cube-sim sweep {slow} {' '.join(asked)} --out out --resume"


def test_the_command_says_what_came_of_it(flown, tmp_path):
    file, result = flown
    done = cube_sim("sweep", file, "--out", "out", cwd=tmp_path)
    assert done.returncode == 1
    assert done.stdout.startswith(
        f"FAIL  short_flight: {result.count('PASS')} of 12 samples pass, all of them wanted\n"
    )
    (command,) = [line.strip() for line in done.stdout.splitlines() if "cube-sim run" in line][:1]
    again = cube_sim(*command.split()[1:], "--record", "none", "--json", cwd=tmp_path)
    k = int(command.split()[-1])
    row = rows_of(tmp_path / "out")[k]
    assert json.loads(again.stdout)["checks"][0]["value"] == row["check.max of path_error.cross_track.value"]
    assert again.returncode == 1


def test_a_required_rate_is_the_verdict(tmp_path, monkeypatch, capsys):
    file = written(tmp_path, SAMPLES + "  required: {pass_rate: 0.1}\n")

    def verdict(out, *more):
        code, told, _ = call(monkeypatch, capsys, "sweep", file, "--out", tmp_path / out, "--json", *more)
        return code, json.loads(told)["verdict"]

    assert verdict("out") == (0, "PASS")
    assert verdict("part", "--shard", "1/3") == (0, None)
    assert verdict("few", "--set", "samples.required.pass_rate=0.9") in {(3, "ERROR"), (1, "FAIL")}


@pytest.mark.parametrize(("rate", "least"), [(0.5, 5), (0.95, 59), (0.99, 299)])
def test_too_few_to_show_a_rate_is_noted_beforehand(tmp_path, monkeypatch, capsys, rate, least):
    for count, noted in ((least - 1, True), (least, False)):
        file = written(tmp_path, f"samples:\n  count: {count}\n  required: {{pass_rate: {rate}}}\n")
        code, _, noticed = call(monkeypatch, capsys, "validate", file)
        words = f"NOTE {file}:13:25: samples.required.pass_rate: {count} samples cannot show {rate}"
        said = f"{words} at 0.95 confidence, even if all pass; {least} can\n"
        assert (code, noticed) == (0, said if noted else "")


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--shard", "3/2"], "--shard 3/2: takes the number of a part and how many there are, from 1/5 to 5/5"),
        (["--resume"], "--resume goes on with what is in a folder: say which by --out"),
        (["--cluster", "tcp://127.0.0.1:1", "--workers", "2"], "--workers and --workers-as are of this machine: they do"
         " not go with --cluster"),
    ],
)  # fmt: skip
def test_bad_arguments(tmp_path, arguments, said):
    done = cube_sim("sweep", written(tmp_path), *arguments, cwd=tmp_path)
    assert (done.returncode, done.stderr) == (2, f"{said}\n")
    assert os.listdir(tmp_path) == ["hull.xml", "swept.yaml"] or not (tmp_path / "logs").exists()


def test_a_scenario_without_samples_has_no_sweep(tmp_path):
    file = written(tmp_path, "")
    done = cube_sim("sweep", file, cwd=tmp_path)
    assert done.returncode == 2
    assert done.stderr == f"{file}:1:1: has no samples: block, so there is no sample of it\n"


def test_a_recording_that_cannot_be_kept_ends_the_sweep_and_spoils_no_row(flown, tmp_path):
    file, _ = flown
    campaign.sweep(load(file, {"samples.count": 1}), tmp_path / "out")
    taken = tmp_path / "out" / "runs" / "5"
    taken.mkdir(parents=True)
    (taken / "thesis.tex").write_text("")
    for way in ("threads", "processes"):
        with pytest.raises(SweepError) as caught:
            swept(file, tmp_path / "out", resume=True, keep="all", workers=1, workers_as=way)
        assert str(caught.value).startswith(f"the recording of sample 5 cannot be kept: {taken}: holds thesis.tex")
        assert str(caught.value).endswith("what is flown stays: go on with --resume once there is room")
    (taken / "thesis.tex").unlink()
    whole = swept(file, tmp_path / "out", resume=True, keep="all", workers=2)
    assert (whole.folder / "rows.parquet").read_bytes() == (flown[1].folder / "rows.parquet").read_bytes()
    assert {int(each.name) for each in (whole.folder / "runs").iterdir()} == set(range(1, 12))


def test_what_own_code_prints_is_no_result(tmp_path):
    (tmp_path / "own.py").write_text(PID.replace("    def law(aim):\n", "    def law(aim):\n        print('seen')\n"))
    samples = "samples:\n  vary:\n    guidance.speed_m_s: {distribution: grid, values: [0.3, 0.4]}\n"
    file = written(tmp_path, samples, FLIGHT + "control: {law: {python: 'own.py:pid'}}\n")
    done = cube_sim("sweep", file, "--json", "--out", "out", cwd=tmp_path)
    assert json.loads(done.stdout)["samples"] == 2
    assert "seen" in done.stderr
