"""A run against an earlier one: alike to the bit from the flight, from the record, and without the earlier run."""

from __future__ import annotations

import shutil

import numpy as np
import pytest
from pydantic import TypeAdapter
from support.places import HELIX, MODELS
from support.random_signals import HELD, RUN_S, SAMPLED, in_random_blocks, random_signals

import cube_sim
from cube_sim.baseline import baseline_signal, table_of_rows
from cube_sim.checks import Beforehand, evaluate
from cube_sim.errors import RecordingError, ScenarioError
from cube_sim.judged_store import beforehand_of
from cube_sim.recording import one_pass
from cube_sim.runs.judged_record import judged_in_one_pass
from cube_sim.runs.judging import judged
from cube_sim.runs.recorded_run import load_run
from cube_sim.scenario import load
from cube_sim.scenario.check_blocks import AnyCheck

SCENARIO = """\
schema_version: 1
name: against
model: {model}
duration_s: 6
path: {{type: line, start_m: [0, 0, -5], end_m: [4, 0, -5]}}
initial: {{position_m: [0, 1, -5]}}
guidance: {{speed_m_s: 0.4}}
current_m_s: [0.05, 0, 0]
checks:
{checks}
"""
CHECKS = """\
  - {kind: baseline, record: RECORD, signal: pose.position, tolerance: 0.5}
  - {kind: baseline, record: RECORD, signal: pose.position, component: 1, from_s: 1.3, to_s: 4.1, tolerance: 0}
  - {kind: baseline, record: RECORD, signal: path_error.cross_track, statistic: rms, from_s: 2, tolerance: 0.1}
  - {kind: baseline, record: RECORD, signal: actuation.limits, tolerance: 0.5}
  - {kind: baseline, record: RECORD, signal: actuation.limits, component: 3, statistic: mean, tolerance: 0.5}"""
ALONE = "  - {kind: allowed_forces}"


def written(folder, checks, name="mission.yaml"):
    folder.mkdir(exist_ok=True)
    (folder / name).write_text(SCENARIO.format(model=MODELS / "cube.xml", checks=checks))
    return folder / name


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    """A folder with an earlier run, longer and in still water, and one against it."""
    folder = tmp_path_factory.mktemp("against")
    earlier = {"current_m_s": [0, 0, 0], "duration_s": 8}
    cube_sim.run(written(folder, ALONE, "alone.yaml"), earlier, folder / "earlier", record="mcap")
    cube_sim.run(written(folder, CHECKS.replace("RECORD", "earlier")), None, folder / "later", record="mcap")
    return folder


def judge(signals, theirs, rng=None, held=(HELD,), **asked):
    check = TypeAdapter(AnyCheck).validate_python({"kind": "baseline", "record": "x", **asked})
    beforehand = Beforehand(held=held, baseline=lambda check: theirs[check.signal])
    (result,) = evaluate([check], signals, duration_s=RUN_S, beforehand=beforehand)
    for _ in range(4 if rng is not None else 0):
        blocks = in_random_blocks(signals, rng)
        assert evaluate([check], blocks, duration_s=RUN_S, beforehand=beforehand) == (result,)
    return result


@pytest.mark.parametrize("component", [None, 0])
def test_a_whole_signal_differs_by_its_largest_distance(component):
    for seed in range(20):
        rng = np.random.default_rng(seed)
        ours = random_signals(rng)
        theirs = {SAMPLED: ours[SAMPLED].copy()}
        theirs[SAMPLED][:, 1:] += rng.normal(size=theirs[SAMPLED][:, 1:].shape)
        theirs[SAMPLED] = np.vstack([theirs[SAMPLED], [[RUN_S + 1.0, *theirs[SAMPLED][-1, 1:]]]])  # lasts longer
        start, end = sorted(float(t) for t in rng.uniform(0.0, RUN_S, 2))
        keys = {"from_s": start, "to_s": end + 0.1} if end + 0.1 < RUN_S else {}
        result = judge(ours, theirs, rng, signal=SAMPLED, component=component, tolerance=1.0, **keys)
        apart = ours[SAMPLED][:, 1:] - theirs[SAMPLED][:-1, 1:]
        distance = np.abs(apart[:, 0]) if component == 0 else np.sqrt((apart**2).sum(axis=1))
        times = ours[SAMPLED][:, 0]
        if keys:
            distance = np.where((times >= start) & (times <= end + 0.1), distance, -1.0)
        assert result.value == pytest.approx(distance.max(), rel=1e-12)
        assert result.at_s == times[distance.argmax()]
        assert (result.relation, result.limit) == ("<=", 1.0)


def test_a_held_signal_is_compared_at_each_change_of_either():
    clock = random_signals(np.random.default_rng(0))
    ours = clock | {HELD: np.array([[0.0, 1.0], [5.0, 2.0], [9.0, 1.0]])}
    theirs = {HELD: np.array([[0.0, 1.0], [5.5, 2.0], [9.0, 4.0], [9.001, 1.0]])}
    for keys, value, at_s in (({}, 3.0, 9.0), ({"to_s": 8.0}, 1.0, 5.0), ({"from_s": 5.2, "to_s": 8.0}, 1.0, 5.2),
                              ({"from_s": 5.5, "to_s": 8.0}, 0.0, 5.5)):  # fmt: skip
        result = judge(ours, theirs, np.random.default_rng(1), signal=HELD, tolerance=0.5, **keys)
        assert (result.value, result.at_s) == (value, at_s)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (None, "nowhere: no such file"),
        (lambda rows: rows[::2], "the baseline has no row of fast.values at 0.05 s"),
        (lambda rows: rows[:100], "the baseline has no row of fast.values at 5 s"),
        (lambda rows: np.delete(rows, 50, axis=0), "the baseline has no row of fast.values at 2.5 s"),
        (lambda rows: np.column_stack([rows, rows[:, 1]]), "in the baseline"),
        (lambda rows: np.where(np.arange(len(rows))[:, None] == 7, [[0.35, *([np.nan] * (rows.shape[1] - 1))]], rows),
         "fast.values is not finite at 0.35 s"),
    ],
)  # fmt: skip
def test_what_the_baseline_lacks_is_an_error(change, said):
    ours = random_signals(np.random.default_rng(4))
    if change is None:
        for signal, statistic in ((SAMPLED, None), (HELD, None), (SAMPLED, "rms")):
            asked = {"kind": "baseline", "record": "nowhere", "signal": signal, "statistic": statistic, "tolerance": 1}
            check = TypeAdapter(AnyCheck).validate_python(asked)
            beforehand = Beforehand(held={HELD}, baseline=beforehand_of(load(HELIX).scenario, ()).baseline)
            (result,) = evaluate([check], ours, duration_s=RUN_S, beforehand=beforehand)
            assert (result.verdict, result.detail) == ("ERROR", said)
        return
    result = judge(ours, {SAMPLED: change(ours[SAMPLED])}, np.random.default_rng(1), signal=SAMPLED, tolerance=1e9)
    assert result.verdict == "ERROR"
    assert said in result.detail


@pytest.mark.flight
def test_the_record_carries_what_it_is_compared_with(flown, tmp_path, monkeypatch):
    monkeypatch.setattr(one_pass, "BLOCK_BYTES", 50_000)
    record = shutil.copy(flown / "later" / "run.mcap", tmp_path)
    run = load_run(record)
    assert [check.verdict for check in run.checks] == ["PASS", "FAIL", "PASS", "PASS", "PASS"]
    assert judged(run)[1] == run.checks
    assert judged_in_one_pass(run.path, lambda _: None).results == run.checks
    carried = [name for name in run.header.inputs if name.endswith(".npy")]
    assert len(carried) == 5
    earlier = load_run(flown / "earlier").signals
    for name in carried:
        rows = baseline_signal(name, "", run.header.inputs).rows
        assert rows.tobytes() == earlier[name.partition("/")[2].removesuffix(".npy")].tobytes()


@pytest.mark.flight
def test_a_table_serves_as_well_and_other_checks_may_be_held_against_a_record(flown, tmp_path):
    rows = load_run(flown / "earlier").signals["pose.position"]
    (tmp_path / "position.npy").write_bytes(table_of_rows(rows))
    checks = "\n".join(CHECKS.splitlines()[:2]).replace("RECORD", "position.npy")
    file = written(tmp_path, checks)
    run = cube_sim.run(file, None, tmp_path / "out", record="none")
    assert run.checks == load_run(flown / "later").checks[:2]
    from cube_sim.runs.judging import nameable
    from cube_sim.scenario.loading import load_checks

    later = load_run(flown / "later")
    assert judged(later, load_checks(file, later.resolved, nameable(later), later.fields))[1] == run.checks


@pytest.mark.flight
@pytest.mark.parametrize(
    ("check", "overrides", "said"),
    [
        ("signal: pose.position", {"duration_s": 9},
         "checks.0.record: pose.position ends at 8 s there, the window at 9 s"),
        ("signal: pose.position", {"control_period_s": 0.04},
         "checks.0.record: pose.position has a row every 0.02 s there, every 0.04 s here: compare a statistic"),
        ("signal: water.current, record: nowhere", {}, "checks.0.record: no such file: "),
        ("signal: water.current, record: mission.yaml", {}, "mission.yaml is not an MCAP file"),
        ("signal: sensor_dvl.velocity", {"navigation": {}}, "records no signal 'sensor_dvl.velocity'; the nearest of"),
        ("signal: pose.position, level: 1", {}, "checks.0.level: a whole signal takes no level: give a statistic"),
    ],
)  # fmt: skip
def test_what_cannot_be_compared_is_refused_before_the_flight(flown, tmp_path, check, overrides, said):
    record = "" if "record:" in check else f"record: {flown / 'earlier'}, "
    file = written(tmp_path, f"  - {{kind: baseline, {record}{check}, tolerance: 1}}")
    with pytest.raises(ScenarioError) as refused:
        cube_sim.run(file, overrides, tmp_path / "out", record="none")
    assert said in str(refused.value)
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        (b"nothing", "is no table of numbers"),
        (table_of_rows(np.zeros((3, 1))), "must hold rows of float64"),
        (table_of_rows(np.zeros((3, 2))), "in the order of time"),
        (table_of_rows(np.zeros((0, 2))), "must hold finite numbers"),
    ],
)
def test_a_file_that_is_no_table_is_said_to_be_none(rows, said, tmp_path):
    (tmp_path / "x.npy").write_bytes(rows)
    with pytest.raises(RecordingError, match=said):
        baseline_signal(str(tmp_path / "x.npy"), "a.b")
