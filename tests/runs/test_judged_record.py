"""A record judged block by block: the same, to the bit, as one that is read as a whole, and in the same memory."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from random import Random

import pytest
from support.laundering import COMPRESSED, with_fresh_checksums, written_anew
from support.places import HELIX

import cube_sim
from cube_sim import judged_store
from cube_sim.errors import RecordingError
from cube_sim.recording import one_pass
from cube_sim.recording.mcap.passing import NotInOrderError
from cube_sim.runs.judged_record import judged_in_one_pass, judged_record
from cube_sim.runs.judging import judged
from cube_sim.runs.recorded_run import load_run
from cube_sim.runs.recovery import recover
from cube_sim.scenario.check_blocks import (
    AllowedForcesCheckBlock,
    AlwaysCheckBlock,
    ComparisonBlock,
    EventuallyCheckBlock,
    ExactWrenchCheckBlock,
    PathEndCheckBlock,
    RatioCheckBlock,
    SignalCheckBlock,
    StatisticBlock,
)

SCENARIOS = HELIX.parent
SHORT = {
    "duration_s": 9.0,
    "checks": [
        {"kind": "signal", "signal": "path_error.cross_track", "statistic": "rms", "from_s": 2.5, "at_most": 1.0},
        {"kind": "allowed_forces"},
    ],
}
DEAD = {"events": [{"kind": "thrusters", "at_s": 3.5, "thrusters": ["T1"], "state": "dead"}]}
MORE_BYTES = 40_000_000
"""Between what a record of 1,200 s takes more than one of 150 s as a whole, some 180 MB, and in blocks, hardly any."""
MOST = """
import sys
from pathlib import Path
from cube_sim.runs.judged_record import judged_record
from cube_sim.runs.judging import judged
from cube_sim.runs.recorded_run import load_run

def most_after(path):
    judged(load_run(path)) if sys.argv[1] == "whole" else judged_record(path, lambda run: None)
    with open("/proc/self/status") as status:  # getrusage begins with what the parent had
        return 1024 * next(int(line.split()[1]) for line in status if line.startswith("VmHWM"))

first = most_after(Path(sys.argv[2]))
print(most_after(Path(sys.argv[3])) - first)
"""


def of(signal, statistic, **rest):
    return SignalCheckBlock(kind="signal", signal=signal, statistic=statistic, **({"at_most": 0.5} | rest))


DEEP = ComparisonBlock(signal="pose.position", component=2, at_most=-1.0, scale=1.0)
SLOW = ComparisonBlock(signal="velocity.linear", at_most=0.4, scale=0.1)
BESIDE = ComparisonBlock(signal="pose.position", minus="target.position", at_most=3.0)
LIMIT = ComparisonBlock(signal="actuation.limits", component=3, at_least=20.0, scale=10.0)
ENERGY = StatisticBlock(signal="power.energy", statistic="increase", from_s=1.0)
WAY = StatisticBlock(signal="target.arc_length", statistic="increase", from_s=1.0)
CHECKS = [
    *(of("path_error.cross_track", statistic) for statistic in ("rms", "mean", "max", "min", "max_abs", "final")),
    of("wrench.demanded", "rms", at_most=None, at_least=1.0, from_s=1.31, to_s=6.77),
    of("pose.position", "mean", component=2, from_s=3.0),
    of("velocity.linear", "max", component=7),
    of("power.voltage", "min", at_most=None, at_least=14.0),
    of("sensor_dvl.velocity", "max"),
    of("path_error.cross_trak", "max"),
    of("path_error.cross_track", "max", from_s=50.0),
    *(of("path_error.cross_track", statistic) for statistic in ("min_abs", "std", "changes", "integral", "increase")),
    of("path_error.attitude", "percentile", percent=95.0, from_s=1.05, to_s=8.83),
    of("velocity.linear", "share_above", level=0.2),
    of("velocity.linear", "share_within", band=(0.1, 0.3), component=0),
    of("thrusters.force", "crossings", level=0.0, component=0),
    of("path_error.attitude", "settling", band=(0.0, 0.2)),
    of("power.motor", "integral", combine="sum"),
    of("pose.position", "percentile", percent=50.0, minus="target.position"),
    of("thrusters.force", "rms", minus="thrusters.force_demanded", component=2),
    AlwaysCheckBlock(kind="always", all=(BESIDE,)),
    *(of("actuation.matrix", statistic, component=3, from_s=3.1) for statistic in ("mean", "std", "max", "changes")),
    of("actuation.limits", "percentile", percent=40.0, combine="sum"),
    AlwaysCheckBlock(kind="always", all=(DEEP, SLOW)),
    AlwaysCheckBlock(kind="always", any=(DEEP, SLOW, LIMIT), from_s=2.03, to_s=7.01),
    EventuallyCheckBlock(kind="eventually", all=(SLOW, LIMIT), within_s=5.0),
    RatioCheckBlock(kind="ratio", numerator=ENERGY, denominator=WAY, at_most=1000.0),
    AllowedForcesCheckBlock(kind="allowed_forces"),
    ExactWrenchCheckBlock(kind="exact_wrench"),
    PathEndCheckBlock(kind="path_end", reach_m=0.5),
]


def told(found, run):
    """Everything that is said of a run; numbers to the bit."""
    extent = run.recorded_s, run.missing_s, run.losses, run.simulated_s, run.ended_early, run.complete, run.flaw
    recorded = run.header, run.recording.channels, run.log, run.end, run.recording.counts, run.recording.changed
    return repr((found, extent)), recorded


def as_a_whole(record, checks):
    run = load_run(record)
    return told(judged(run, checks), run)


def block_by_block(record, checks, judge=judged_record):
    found = judge(record, lambda _: checks)
    return told((found.verdict, found.results, found.remarks), found.run)


def outcome(how, *arguments):
    try:
        return how(*arguments)
    except RecordingError as error:
        return str(error)


@pytest.fixture(autouse=True)
def small_blocks(monkeypatch):
    monkeypatch.setattr(one_pass, "BLOCK_BYTES", 100_000)
    monkeypatch.setattr(judged_store, "BLOCK_S", 2.0)


@pytest.fixture(scope="module")
def record(tmp_path_factory):
    """Of a flight on which a thruster dies, so that rows on change come late as well."""
    folder = tmp_path_factory.mktemp("run")
    cube_sim.run(HELIX, SHORT | DEAD, folder, record="mcap")
    return folder / "run.mcap"


@pytest.mark.flight
@pytest.mark.parametrize("name", ["cube_helix", "cube_navigated", "cube_lose_one", "bluerov2_battery", "infante_line"])
def test_block_by_block_is_the_same_as_the_whole(tmp_path, name):
    settings = SHORT | DEAD if name == "cube_lose_one" else SHORT
    cube_sim.run(SCENARIOS / f"{name}.yaml", settings, tmp_path, record="mcap")
    record = tmp_path / "run.mcap"
    for checks in (None, CHECKS):
        assert block_by_block(record, checks, judged_in_one_pass) == as_a_whole(record, checks)
    run, whole = judged_in_one_pass(record, lambda _: ()).run, load_run(record)
    assert list(run.recording.rows) == list(whole.recording.rows)
    for name, rows in whole.signals.items():  # read from the file, each when it is asked for
        assert run.signals[name].tobytes() == rows.tobytes(), name


@pytest.mark.flight
@pytest.mark.parametrize("how", COMPRESSED)
def test_another_compression_changes_nothing(record, tmp_path, how):
    new = written_anew(record, target=tmp_path / "new.mcap", **COMPRESSED[how])
    assert block_by_block(new, CHECKS) == as_a_whole(record, CHECKS)
    if how == "no chunks":
        with pytest.raises(NotInOrderError):
            judged_in_one_pass(new, lambda _: CHECKS)
    else:
        assert block_by_block(new, CHECKS, judged_in_one_pass) == as_a_whole(record, CHECKS)


ORDERS = {
    "backwards": lambda found: -found[2].log_time,
    "channel after channel": lambda found: (found[1].id, found[2].log_time),
    "shuffled": lambda found: hash((found[2].log_time * 7919, found[1].id)) % 1009,
}


@pytest.mark.flight
@pytest.mark.parametrize("how", ORDERS)
def test_another_order_is_read_as_a_whole(record, tmp_path, how):
    new = written_anew(record, target=tmp_path / "new.mcap", order=ORDERS[how], chunk_size=20_000)
    with pytest.raises(NotInOrderError):
        judged_in_one_pass(new, lambda _: CHECKS)
    assert block_by_block(new, CHECKS) == as_a_whole(record, CHECKS)


@pytest.mark.flight
def test_lost_sequence_numbers_and_two_runs_in_a_file_are_treated_as_before(record, tmp_path):
    new = written_anew(record, target=tmp_path / "new.mcap", sequence=lambda _: 0)
    assert block_by_block(new, CHECKS) == as_a_whole(record, CHECKS)
    merged = written_anew(record, record, target=tmp_path / "merged.mcap")
    with pytest.raises(RecordingError, match="holds two runs, or one twice"):
        judged_record(merged, lambda _: CHECKS)


def damaged(record: Path, random: Random) -> bytes:
    data = record.read_bytes()

    def flipped(inside: bytearray) -> None:
        for _ in range(random.choice((1, 1, 2, 8))):
            inside[random.randrange(len(inside))] ^= 1 << random.randrange(8)

    def cut(inside: bytearray) -> None:
        start = random.randrange(len(inside))
        del inside[start : start + random.choice((1, 9, 100, 10_000))]

    inside, start = bytearray(data), random.randrange(len(data))
    match random.choice(("flipped", "cut off", "cut out", "doubled", "fresh", "fresh cut")):
        case "flipped":
            flipped(inside)
        case "cut off":
            del inside[start:]
        case "cut out":
            cut(inside)
        case "doubled":
            return data[: start + random.choice((1, 100, 50_000))] + data[start:]
        case "fresh":
            return with_fresh_checksums(data, flipped, random)
        case "fresh cut":
            return with_fresh_checksums(data, cut, random)
    return bytes(inside)


@pytest.mark.flight
def test_of_a_damaged_record_the_same_is_said(record, tmp_path):
    path, streamed = tmp_path / "run.mcap", 0
    for seed in range(150):
        path.write_bytes(damaged(record, Random(seed)))
        expected = outcome(as_a_whole, path, CHECKS)
        assert outcome(block_by_block, path, CHECKS) == expected, seed
        streamed += not isinstance(outcome(block_by_block, path, CHECKS, judged_in_one_pass), str)
    assert streamed > 20  # those that were cut off, or of which a row was altered


@pytest.mark.flight
def test_of_a_recovered_record_the_same_is_said(record, tmp_path):
    data = bytearray(record.read_bytes())
    places = [k for k in range(len(data)) if data[k : k + 8] == b"\x04\0\0\0zstd"]
    data[places[4] - 2] ^= 1  # its checksum
    (tmp_path / "run.mcap").write_bytes(data)
    saved = recover(tmp_path / "run.mcap", tmp_path / "saved").directory / "run.mcap"
    expected = as_a_whole(saved, CHECKS)
    assert "nothing is recorded from" in expected[0]
    assert block_by_block(saved, CHECKS, judged_in_one_pass) == expected


@pytest.mark.flight
@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="the largest memory is told in KiB on Linux")
def test_a_longer_record_takes_no_more_memory(tmp_path):
    records = []
    for duration_s in (150.0, 1200.0):
        cube_sim.run(HELIX, {"duration_s": duration_s}, tmp_path / f"{duration_s:g}", record="mcap")
        records.append(tmp_path / f"{duration_s:g}" / "run.mcap")
    more = {}
    for how in ("whole", "blocks"):
        command = [sys.executable, "-c", MOST, how, *records]
        more[how] = int(subprocess.run(command, check=True, capture_output=True, text=True).stdout)
    assert more["blocks"] < MORE_BYTES < more["whole"]
