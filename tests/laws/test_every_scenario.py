"""What holds of every scenario in scenarios/, flown for a second in which all its events happen."""

from __future__ import annotations

import numpy as np
import pytest
from support.flights import FORCES_ONLY
from support.places import SCENARIO_FILES

import cube_sim
from cube_sim.recording.reading import read_recording
from cube_sim.runs.recorded_run import load_run
from cube_sim.runs.replay import replay
from cube_sim.scenario import load

pytestmark = pytest.mark.flight

LASTS_S = 1.0


def shortened(path):
    """Overrides that end a scenario after LASTS_S and bring its events forward in proportion."""
    scenario = load(path).scenario
    share = LASTS_S / scenario.duration_s
    events = {f"events.{i}.at_s": event.at_s * share for i, event in enumerate(scenario.events)}
    return {"duration_s": LASTS_S, "checks": FORCES_ONLY, **events}


@pytest.fixture(scope="module", params=SCENARIO_FILES, ids=lambda path: path.stem)
def path(request):
    return request.param


@pytest.fixture(scope="module")
def flown(path, tmp_path_factory):
    return cube_sim.run(path, shortened(path), tmp_path_factory.mktemp(path.stem))


def test_it_is_flown_to_its_end_and_every_number_is_finite(path, flown):
    """But for the way that is left on a path without end."""
    curve = load(path).scenario.path
    without_end = getattr(curve, "laps", 1.0) is None and getattr(curve, "closed", True)
    assert flown.verdict == "PASS"
    for name, rows in flown.signals.items():
        assert np.isfinite(rows[:, 0]).all(), name
        values = rows[:, 1:]
        infinite = without_end and name == "target.remaining"
        assert np.isposinf(values).all() if infinite else np.isfinite(values).all(), name
    assert flown.signals["pose.position"][-1, 0] == pytest.approx(LASTS_S, abs=1e-9)


def test_every_signal_its_checks_name_is_recorded(path, flown):
    named = [check for check in load(path).scenario.checks if check.kind == "signal"]
    for check in named:
        width = flown.signals[check.signal].shape[1] - 1
        assert check.component is None or check.component < width, check.title


def test_what_is_recorded_reads_back(flown):
    recording = read_recording(flown.directory / "run.mcap")
    assert recording.complete
    assert recording.signals.keys() == flown.signals.keys()
    for name, rows in flown.signals.items():
        np.testing.assert_array_equal(recording.signals[name], rows, err_msg=name)


def test_flown_again_it_leaves_the_same_bytes(path, flown, tmp_path):
    again = cube_sim.run(path, shortened(path), tmp_path / "again", record="mcap")
    assert (again.directory / "run.mcap").read_bytes() == (flown.directory / "run.mcap").read_bytes()


def test_the_resolved_scenario_it_leaves_flies_the_same(flown, tmp_path):
    again = cube_sim.run(flown.directory / "resolved.yaml", None, tmp_path / "again", record="none")
    assert again.signals.keys() == flown.signals.keys()
    for name, rows in flown.signals.items():
        assert again.signals[name].tobytes() == rows.tobytes(), name


def test_its_record_alone_flies_the_same(flown):
    again = replay(load_run(flown.directory))
    assert again.identical, (again.differences[:1], again.other_log)
    assert again.until_s == LASTS_S
    assert not again.other_versions
