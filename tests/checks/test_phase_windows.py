"""Windows that a phase of the mission opens and closes."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
from pydantic import TypeAdapter
from support.fleets import PAIR
from support.places import CUBE, SCENARIOS
from support.random_signals import HELD, PERIOD_S, RUN_S, SAMPLED, in_random_blocks, random_signals
from support.scenario_files import mistakes, write

import cube_sim
from cube_sim.checks import Beforehand, evaluate
from cube_sim.errors import ScenarioError
from cube_sim.report.check_panels import check_panels
from cube_sim.report.happenings import PHASE, happenings
from cube_sim.report.page import report
from cube_sim.report.subject import Subject
from cube_sim.runs.judged_record import judged_record
from cube_sim.scenario.check_blocks import AnyCheck
from cube_sim.scenario.fleet_loading import load_any

NAMES = "out", "look around", "home"
BEFOREHAND = Beforehand(held={HELD, "phase.index"}, phases=NAMES)
SURVEY = SCENARIOS / "cube_waypoints.yaml"


def block(**asked):
    return TypeAdapter(AnyCheck).validate_python(asked)


def phased(rng, flown=3):
    """Signals at random with phases that begin at ticks; and when each of them is over."""
    signals = random_signals(rng)
    ticks = np.sort(rng.choice(np.arange(20, round(RUN_S / PERIOD_S) - 20), flown - 1, replace=False)) * PERIOD_S
    signals["phase.index"] = np.column_stack([[0.0, *ticks], np.arange(float(flown))])
    return signals, [0.0, *ticks.tolist(), RUN_S]


def asked_of(rng, signal):
    """Checks of every kind that has a window, of one signal."""
    mean = {"signal": signal, "statistic": str(rng.choice(["mean", "max", "rms", "final", "std", "increase"]))}
    settling = {"signal": signal, "statistic": "settling", "band": (-9.0, 9.0)}
    limit = {"at_most": float(rng.uniform(0.0, 2.0))}
    yield {"kind": "signal", **mean, **limit}
    yield {"kind": "signal", **settling, "at_most": 0.5}
    for kind in ("always", "eventually"):
        yield {"kind": kind, "any": [{"signal": signal, **limit, "scale": 1.0}, {"signal": SAMPLED, "at_least": 0.5,
                                                                                   "scale": 2.0}]}  # fmt: skip


def with_window(asked, **window):
    return block(**asked, **window)


@pytest.mark.parametrize("signal", [SAMPLED, HELD])
def test_a_phase_is_the_window_after_its_start_up_to_its_last_tick(signal):
    for seed in range(60):
        rng = np.random.default_rng([seed, signal == HELD])
        signals, starts = phased(rng)
        phase = int(rng.integers(0, 3))
        from_s = float(rng.choice([0.0, rng.uniform(0.0, 0.8 * (starts[phase + 1] - starts[phase]))]))
        start = starts[phase] + from_s
        if phase and not from_s:
            start = np.nextafter(start, np.inf)
        for asked in asked_of(rng, signal):
            name = str(rng.choice([NAMES[phase], ""])) or phase
            check = with_window(asked, phase=name, **({"from_s": from_s} if from_s else {}))
            (result,) = evaluate([check], signals, duration_s=RUN_S, beforehand=BEFOREHAND)
            for _ in range(3):
                again = evaluate([check], in_random_blocks(signals, rng), duration_s=RUN_S, beforehand=BEFOREHAND)
                assert again == (result,)
            window = {"from_s": start, "to_s": starts[phase + 1]} if start > 0 else {"to_s": starts[phase + 1]}
            (expected,) = evaluate([with_window(asked, **window)], signals, duration_s=RUN_S, beforehand=BEFOREHAND)
            if signal == HELD and asked["kind"] in ("always", "eventually"):
                # The instant at which an explicit window starts counts, that of a phase is the last one's.
                assert result.verdict != "ERROR"
                continue
            assert result.verdict == expected.verdict, (seed, asked)
            assert result.value == pytest.approx(expected.value, abs=1e-9), (seed, asked)


def test_what_is_held_alone_counts_from_the_start_of_the_phase():
    signals = random_signals(np.random.default_rng(0))
    signals[HELD] = np.array([[0.0, 3.0], [6.0, 1.0]])
    signals["phase.index"] = np.array([[0.0, 0.0], [4.0, 1.0], [8.0, 2.0]])
    for phase, largest in (("out", 3.0), (1, 3.0), ("home", 1.0)):
        check = block(kind="always", all=[{"signal": HELD, "at_most": 5.0}], phase=phase)
        (result,) = evaluate([check], signals, duration_s=RUN_S, beforehand=BEFOREHAND)
        assert (result.verdict, result.value) == ("PASS", largest)


@pytest.mark.parametrize(
    ("keys", "said"),
    [
        ({"phase": "home"}, "phase 'home' was never entered"),
        ({"phase": 2}, "phase '2' was never entered"),
        ({"phase": "out", "from_s": 11.5}, "was over at"),
    ],
)
def test_what_was_not_flown_cannot_be_judged(keys, said):
    signals, _ = phased(np.random.default_rng(1), flown=2)
    for asked in ({"kind": "signal", "signal": SAMPLED, "statistic": "mean", "at_most": 9.0},
                  {"kind": "signal", "signal": HELD, "statistic": "mean", "at_most": 9.0},
                  {"kind": "always", "all": [{"signal": SAMPLED, "at_most": 9.0}]},
                  {"kind": "eventually", "any": [{"signal": HELD, "at_most": 9.0}]}):  # fmt: skip
        (result,) = evaluate([block(**asked, **keys)], signals, duration_s=RUN_S, beforehand=BEFOREHAND)
        assert result.verdict == "ERROR"
        assert said in result.detail


CHECK = "kind: signal, signal: path_error.cross_track, statistic: max, at_most: 0.5"
FILE = f"""\
schema_version: 1
name: legs
model: {CUBE}
duration_s: 60
initial: {{position_m: [0, 0, -5]}}
guidance: {{speed_m_s: 0.4}}
phases:
  - {{name: out, path: {{type: line, start_m: [0, 0, -5], end_m: [3, 0, -5]}}}}
  - {{name: rest, path: {{type: point, position_m: [3, 0, -5]}}, for_s: 4}}
  - {{name: out, path: {{type: line, start_m: [3, 0, -5], end_m: [6, 0, -5]}}}}
checks:
"""


@pytest.mark.parametrize(
    ("check", "expected"),
    [
        (f"{{{CHECK}, phase: home}}", "phase: no phase 'home'; there are 0: out; 1: rest; 2: out"),
        (f"{{{CHECK}, phase: 3}}", "phase: no phase 3; there are 0: out; 1: rest; 2: out"),
        (f"{{{CHECK}, phase: out}}", "phase: phases 0 and 2 are both called 'out'; say which by its number"),
        (f"{{{CHECK}, phase: -1}}", "phase: must be the name of a phase, or its number in the list of phases, from 0"),
        (f"{{{CHECK}, phase: rest, from_s: 4}}", "from_s: 4 s after it begins the phase is over, which lasts 4 s"),
        (f"{{{CHECK}, phase: rest, to_s: 5}}", "to_s: the window ends 5 s after the phase begins, which lasts 4 s"),
        (f"{{{CHECK}, phase: rest, from_s: -1}}", "from_s: must be at least 0"),
        (f"{{{CHECK}, phase: rest, to_event: 0}}", "to_event: the window belongs to a phase"),
        (f"{{{CHECK}, phase: 0, from_s: 70}}", "from_s: 70 s after the phase begins the run has ended, at 60 s"),
        ("{kind: ratio, at_most: 1, numerator: {signal: a.b, statistic: mean},"
         " denominator: {signal: a.b, statistic: rms, phase: homw}}", "denominator.phase: no phase 'homw'"),
    ],
)  # fmt: skip
def test_a_phase_that_there_is_not_is_refused_where_it_is_written(check, expected, tmp_path):
    (line,) = mistakes(write(tmp_path, f"{FILE}  - {check}\n"))
    place, _, said = line.partition(": checks.0.")
    assert said.startswith(expected)
    row, column = map(int, place.split(":")[1:])
    key = expected.partition(":")[0].rpartition(".")[2]
    assert check[: column - 5].endswith(f"{key}: ")
    assert row == 12


def test_without_phases_none_is_known(tmp_path):
    text = FILE[: FILE.index("phases:")] + "path: {type: line, start_m: [0, 0, -5], end_m: [3, 0, -5]}\nchecks:\n"
    (line,) = mistakes(write(tmp_path, f"{text}  - {{{CHECK}, phase: out}}\n"))
    assert line.endswith("phase: no phase 'out'; the scenario has none")


def test_over_several_vehicles_a_phase_says_nothing(tmp_path):
    path = tmp_path / "pair.yaml"
    path.write_text(PAIR.replace("statistic: min, at_least: 1.0", "statistic: min, at_least: 1.0, phase: out"))
    with pytest.raises(ScenarioError, match=r"checks.0.phase: phases are of one vehicle: ask it among the checks"):
        load_any(path)


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    checks = [
        {"kind": "signal", "signal": "path_error.cross_track", "statistic": "max", "phase": name, "at_most": 0.5}
        for name in ("first line", "second line", "second line: hold", "way back")
    ]
    checks.append({"kind": "always", "phase": "way back", "all": [{"signal": "actuation.limits", "component": 3,
                                                                    "at_least": 10.0}]})  # fmt: skip
    folder = tmp_path_factory.mktemp("phases") / "run"
    return cube_sim.run(SURVEY, {"checks": checks}, out=folder), folder


@pytest.mark.flight
def test_the_flight_and_its_record_say_the_same(flown, tmp_path):
    run, folder = flown
    assert [check.verdict for check in run.checks] == ["PASS"] * 5
    error, starts = run.signals["path_error.cross_track"], [*run.signals["phase.index"][:, 0], np.inf]
    for phase, check in enumerate(run.checks[:4]):
        inside = (error[:, 0] > starts[phase] - (phase == 0)) & (error[:, 0] <= starts[phase + 1])
        assert check.value == error[inside, 1].max()
        assert check.at_s == error[inside, 0][np.argmax(error[inside, 1])]
    again = judged_record(folder, lambda run: None)
    assert again.results == cube_sim.load_run(folder).checks == run.checks
    judged = cube_sim.run(folder / "resolved.yaml", out=tmp_path / "judged", record="none", keep_signals=False)
    assert judged.checks == run.checks


@pytest.mark.flight
def test_the_report_shades_the_phases_and_names_them(flown):
    run, folder = flown
    loaded = cube_sim.load_run(folder)
    subject = Subject(loaded, "a", "#000")
    starts = [*run.signals["phase.index"][:, 0].tolist(), loaded.recorded_s]
    assert [(each.start_s, each.end_s) for each in subject.phases] == list(pairwise(starts))
    told = [each for each in happenings(subject) if each.kind == PHASE]
    assert [each.text for each in told][-1] == "phase 4 of 4: way back"
    page = report([loaded], ["a"])
    assert '">way back</text>' in page
    panel = next(each for each in check_panels([subject]) if each.title == "path_error.cross_track")
    windows = [(guide.start_s, guide.end_s) for guide in panel.guides]
    assert windows == [pytest.approx(each) for each in pairwise(starts)]


@pytest.mark.flight
def test_a_run_that_stops_before_a_phase_leaves_its_check_open(tmp_path):
    checks = [{"kind": "signal", "signal": "path_error.cross_track", "statistic": "max", "phase": "way back",
               "at_most": 0.5}]  # fmt: skip
    stop = [{"kind": "signal", "signal": "pose.position", "component": 0, "above": 3.0, "verdict": "pass"}]
    run = cube_sim.run(SURVEY, {"checks": checks, "stop": stop}, out=tmp_path / "run")
    assert run.verdict == "ERROR"
    assert run.checks[0].detail == "phase 'way back' was never entered"
