"""The record of several vehicles: read back, judged again, flown again, and shown."""

import json
from xml.etree import ElementTree

import numpy as np
import pytest
from support.fleets import PAIR, fly, loaded_fleet, write

import cube_sim
from cube_sim.errors import RecordingError
from cube_sim.recording.export import rrd_from_mcap
from cube_sim.report.page import report
from cube_sim.runs.judged_record import judged_record
from cube_sim.runs.judging import judged
from cube_sim.runs.recorded_run import load_run
from cube_sim.runs.recovery import recover
from cube_sim.runs.replay import replay

pytestmark = pytest.mark.flight
TEXT = PAIR.replace(
    "  leader:\n", "  leader:\n    events: [{kind: thrusters, at_s: 3, thrusters: [T1, T4], state: dead}]\n"
)


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    folder = tmp_path_factory.mktemp("fleet")
    return cube_sim.run(write(folder, TEXT), out=folder / "run", record="full")


def test_it_is_read_back_to_the_bit_under_the_names_of_the_vehicles(flown):
    run = load_run(flown.directory)
    assert list(run.vehicles) == ["leader", "follower"]
    assert run.complete
    assert run.verdict == flown.verdict == "PASS"
    assert set(run.signals) == set(flown.signals)
    for name, rows in flown.signals.items():
        assert run.signals[name].tobytes() == rows.tobytes(), name
    leader = run.vehicles["leader"]
    assert leader.scenario.path.type == "line"
    assert leader.signals["pose.position"].tobytes() == flown.signals["leader/pose.position"].tobytes()
    assert [line.text for line in leader.log if line.t == 3.0] == ["T1, T4: dead"]
    assert not [line for line in run.vehicles["follower"].log if "dead" in line.text]
    with pytest.raises(RecordingError, match="is of several vehicles: leader, follower"):
        _ = run.scenario


def test_it_is_judged_again_as_it_was(flown):
    run = load_run(flown.directory)
    names = [check.name for check in flown.checks]
    assert names == [
        "leader: final of path_error.cross_track",
        "min distance between follower and leader",
        "final of follower/path_error.cross_track",
    ]
    assert judged(run)[:2] == (flown.verdict, flown.checks)
    assert judged_record(flown.directory, lambda _: None).results == flown.checks
    told = json.loads((flown.directory / "verdict.json").read_text())
    assert [check["name"] for check in told["checks"]] == names
    distance = flown.checks[1]
    assert distance.value == flown.signals["distance.leader_to_follower"][:, 1].min()
    assert (distance.relation, distance.unit) == (">=", "m")


def test_a_check_over_several_that_fails_fails_the_run(tmp_path):
    path = write(tmp_path, TEXT.replace("at_least: 1.0", "at_least: 100.0"))
    run = cube_sim.run(path, out=tmp_path / "run", record="none")
    assert run.verdict == "FAIL"
    assert [check.verdict for check in run.checks] == ["PASS", "FAIL", "PASS"]


def test_the_record_alone_flies_again_to_the_bit(flown):
    found = replay(load_run(flown.directory / "run.mcap"))
    assert found.identical
    assert found.signals == len(flown.signals)


def test_resolved_it_flies_the_same(flown, tmp_path):
    again = cube_sim.run(flown.directory / "resolved.yaml", out=tmp_path / "again", record="mcap")
    for name, rows in flown.signals.items():
        assert again.signals[name].tobytes() == rows.tobytes(), name


def test_the_same_file_gives_the_same_bytes(flown, tmp_path):
    write(tmp_path, TEXT)
    again = cube_sim.run(tmp_path / "pair.yaml", out=tmp_path / "again", record="mcap")
    assert (again.directory / "run.mcap").read_bytes() == (flown.directory / "run.mcap").read_bytes()


def test_memory_and_files_hold_the_same(flown, tmp_path):
    _, store = fly(loaded_fleet(write(tmp_path, TEXT)))
    for name, rows in flown.signals.items():
        assert store.signals[name].tobytes() == rows.tobytes(), name
    assert tuple(line for line in store.lines if line.level == "WARNING") == flown.log


def test_its_report_has_every_vehicle_and_what_joins_them(flown):
    page = report([load_run(flown.directory)], ["pair"])
    ElementTree.fromstring(page.partition("\n")[2])
    for words in ("leader", "follower", "min distance between follower and leader", "distance.leader_to_follower"):
        assert words in page


def test_its_view_is_made_of_the_record_with_every_hull(flown, tmp_path):
    rrd_from_mcap(flown.directory / "run.mcap", tmp_path / "again.rrd")
    for view in (flown.directory / "run.rrd", tmp_path / "again.rrd"):
        content = view.read_bytes()
        for entity in (b"/leader/world/vehicle", b"/follower/world/trail", b"/plot/distance/leader_to_follower"):
            assert entity in content


def test_what_is_left_of_a_cut_record_is_saved(flown, tmp_path):
    content = (flown.directory / "run.mcap").read_bytes()
    (tmp_path / "run.mcap").write_bytes(content[: len(content) * 2 // 3])
    cut = load_run(tmp_path)
    assert not cut.complete
    assert judged(cut)[0] == "ERROR"
    saved = recover(tmp_path / "run.mcap", tmp_path / "saved")
    assert not isinstance(saved, str)
    again = load_run(tmp_path / "saved")
    assert list(again.vehicles) == ["leader", "follower"]
    for name, rows in again.vehicles["leader"].signals.items():
        assert rows.tobytes() == flown.signals[f"leader/{name}"][: len(rows)].tobytes(), name
    assert (tmp_path / "saved" / "run.rrd").stat().st_size > 0


def test_tables_and_figures_are_made_of_it(flown, tmp_path):
    from cube_sim.report.colours import BLUE
    from cube_sim.report.figure import save_figure
    from cube_sim.report.subject import Subject
    from cube_sim.runs.tables import tables_of, write_csv

    run = load_run(flown.directory)
    files = [write_csv(table, tmp_path) for table in tables_of(run)]
    assert tmp_path / "leader" / "pose.csv" in files
    assert tmp_path / "distance.csv" in files
    rows = np.loadtxt(tmp_path / "follower" / "pose.csv", delimiter=",", skiprows=1)
    assert np.array_equal(rows[:, 1:4], flown.signals["follower/pose.position"][:, 1:])
    for subject in (Subject(run.together, "pair", BLUE), Subject(run.vehicles["leader"], "leader", BLUE)):
        signals = ("distance.leader_to_follower",) if subject.label == "pair" else ()
        save_figure(subject, signals, tmp_path / f"{subject.label}.png")
        assert (tmp_path / f"{subject.label}.png").stat().st_size > 1000
