"""What a page says of flights that fail for a reason: the reason, on every plot, and in the row of what it failed."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET

import pytest
from support.places import HELIX
from support.synthetic_run import synthetic_run

import cube_sim
from cube_sim.report.circumstances import circumstances
from cube_sim.report.happenings import happenings
from cube_sim.report.page import report
from cube_sim.report.subject import Subject
from cube_sim.run_conditions import BALLAST_DROPPED, BATTERY_EMPTY, PATH_GIVEN_UP, SPEED_NOT_KEPT
from cube_sim.run_log import LogLine

LINE = {"type": "line", "start_m": [0, 0, -5], "end_m": [8, 0, -5]}
BEGIN = {"initial": {"position_m": [0, 0, -5]}, "path": LINE, "guidance": {"speed_m_s": 0.4}}
REACHED = [{"kind": "path_end", "reach_m": 0.5}]


def flown(folder, **changes):
    return cube_sim.load_run(cube_sim.run(HELIX, {**BEGIN, **changes}, folder / "run", record="mcap").directory)


def told(run):
    return {each.kind: each for each in happenings(Subject(run, "run", "#000"))}


def plots_of(page):
    root = ET.fromstring(page.partition("\n")[2])
    return [svg for svg in root.iter("svg") if "time" in (svg.get("class") or "")]


def flags(plot):
    return sum(path.get("class") == "m" for path in plot.iter("path"))


@pytest.mark.flight
def test_an_empty_battery_is_why(tmp_path):
    battery = {"open_circuit_V": [11.0, 14.8], "resistance_ohm": 0.1, "capacity_Wh": 0.3, "charge": 0.8}
    charge = {"kind": "signal", "signal": "power.charge", "statistic": "final", "at_least": 0.05}
    run = flown(tmp_path, duration_s=22.0, battery=battery, checks=[charge, *REACHED])
    subject = Subject(run, "run", "#000")
    rows = subject.rows("power.charge")
    empty = float(rows[rows[:, 1] == 0.0][0, 0])
    assert empty < 15.0
    assert (told(run)["battery"].t, told(run)["battery"].text) == (empty, BATTERY_EMPTY.begins)
    assert [each.text for each in happenings(subject)].count(BATTERY_EMPTY.begins) == 1
    assert [result.verdict for result in subject.results] == ["FAIL", "FAIL"]
    for result in subject.results:
        said = circumstances(subject, result.at_s)
        assert said[0] == f"{BATTERY_EMPTY.begins} (since {empty:g} s)"
        assert not any("at 0 s" in line for line in said)
    page = report([run], ["run"])
    assert {flags(plot) for plot in plots_of(page)} == {len(happenings(subject))}
    assert "are those of What happened" in page


@pytest.mark.flight
def test_a_current_that_stops_it_is_why(tmp_path):
    """It began long before the check was at its worst, at the end."""
    event = {"kind": "current", "at_s": 6.0, "current_m_s": [-0.9, 0.0, 0.0]}
    run = flown(tmp_path, duration_s=26.0, events=[event], checks=REACHED)
    subject = Subject(run, "run", "#000")
    (result,) = subject.results
    assert result.verdict == "FAIL"
    said = circumstances(subject, result.at_s)
    (slow,) = (each for each in happenings(subject) if each.text.startswith(SPEED_NOT_KEPT.begins))
    assert slow.t < result.at_s - 10.0
    causes = [line for line in said if re.search(r"\(since [\d.]+ s\)$", line)]
    assert causes == [
        f"{slow.text} (since {slow.t:g} s)",
        "current becomes [-0.9, 0, 0] m/s (since 6 s)",
    ]
    assert [each.kind for each in happenings(subject) if each.t == 6.0] == ["event"], "not once more, as a warning"


@pytest.mark.flight
def test_a_path_given_up_and_ballast_dropped_are_why(tmp_path):
    names = [f"T{k}" for k in range(1, 9)]
    dead = {"kind": "thrusters", "at_s": 2.0, "thrusters": names, "state": "dead"}
    safe = {"action": "surface", "surface_m": -4.0, "drop_weight_N": 15.0}
    run = flown(tmp_path, **{"duration_s": 12.0, "events": [dead], "checks": REACHED, "control.safe_mode": safe})
    subject = Subject(run, "run", "#000")
    found = [each for each in happenings(subject) if each.kind == "warning"]
    starts = [condition.begins for condition in (PATH_GIVEN_UP, BALLAST_DROPPED)]
    assert [any(each.text.startswith(start) for each in found) for start in starts] == [True, True]
    said = circumstances(subject, 11.9)
    assert [any(line.startswith(start) and "(since" in line for line in said) for start in starts] == [True, True]
    believed = [each.text for each in happenings(subject) if each.kind == "belief"]
    assert any("T8" in text for text in believed)
    assert not any(each.text in text for each in found for text in believed), "not once more, as a warning"


def test_what_is_over_is_no_cause():
    slow, again = f"{SPEED_NOT_KEPT.begins}0.4 m/s", SPEED_NOT_KEPT.ends
    log = (
        LogLine(2.0, "WARNING", "T1: dead"),
        LogLine(3.0, "WARNING", slow),
        LogLine(4.0, "WARNING", f"{PATH_GIVEN_UP.begins}too far"),
        LogLine(4.0, "WARNING", BALLAST_DROPPED.begins),
        LogLine(5.0, "INFO", again),
        LogLine(6.0, "WARNING", PATH_GIVEN_UP.ends),
        LogLine(6.5, "WARNING", "MuJoCo: odd"),
        LogLine(6.6, "WARNING", "MuJoCo: odd"),
    )
    run = Subject(synthetic_run(log=log), "run", "#000")
    found = [(each.t, each.kind, each.text) for each in happenings(run)]
    assert found == [
        (2.0, "event", "T1: dead"),
        (2.5, "belief", "the controller believes: T1 dead"),
        (3.0, "warning", slow),
        (4.0, "warning", f"{PATH_GIVEN_UP.begins}too far"),
        (4.0, "warning", BALLAST_DROPPED.begins),
        (6.0, "warning", PATH_GIVEN_UP.ends),
        (6.5, "warning", "MuJoCo: odd (+1 more like this, the last at 6.6 s)"),
    ]
    lasts = [line for line in circumstances(run, 4.5) if "(since" in line]
    assert lasts == [
        f"{PATH_GIVEN_UP.begins}too far (since 4 s)",
        f"{BALLAST_DROPPED.begins} (since 4 s)",
        f"{slow} (since 3 s)",
    ]
    assert [line for line in circumstances(run, 9.9) if "(since" in line] == [f"{BALLAST_DROPPED.begins} (since 4 s)"]


def test_a_wrench_that_was_not_made_is_told_where_that_began():
    run = synthetic_run(
        log=(
            LogLine(9.0, "WARNING", "the demanded wrench was out of reach, and the closest attainable one made: long"),
        )
    )
    rows = run.recording.rows["allocation"]
    column = next(c for c in run.recording.channels if c.name == "allocation").fields
    at = 1 + sum(field.width for field in column[: [field.name for field in column].index("status")])
    rows[(rows[:, 0] >= 1.0) & (rows[:, 0] < 2.0), at] = 1.0  # before the controller took T1 for dead: of another
    rows[(rows[:, 0] >= 5.0) & (rows[:, 0] <= 8.0), at] = 1.0
    (each,) = (each for each in happenings(Subject(run, "run", "#000")) if each.kind == "wrench")
    assert each.t == 5.0


def test_a_thruster_kept_just_below_its_limit_is_named():
    run = synthetic_run()
    rows = run.recording.rows["thrusters"]
    rows[rows[:, 0] >= 3.0, 2] = 48.0  # T2, of 50 N
    subject = Subject(run, "run", "#000")
    (said,) = (line for line in circumstances(subject, 9.5) if "T2" in line)
    assert said.startswith("T2 at 96 % of its upper limit on average since ")
    assert subject.thrusters[1].near_since(9.5)[0] == pytest.approx(3.0, abs=0.1)
    assert not any("T2" in line for line in circumstances(subject, 7.0)), "not for long enough"
    assert subject.thrusters[1].near_since(2.0) is None
    assert "at most 96 %" in report([run], ["run"])
