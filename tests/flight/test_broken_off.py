"""A flight that MuJoCo cannot go on with ends with one clear line, in compiled code as in Python."""

from __future__ import annotations

import mujoco
import pytest
from support.places import HELIX, MODELS

import cube_sim
from cube_sim.flight import Flight, loop
from cube_sim.recording.reading import read_recording
from cube_sim.vehicle.plugin import guard

SHORT = {"duration_s": 3.0, "checks": [{"kind": "allowed_forces"}]}
pytestmark = pytest.mark.skipif(not guard.guards(), reason="no POSIX threads")


@pytest.fixture
def crowded(tmp_path):
    """The helix above 25 boxes that fall on a floor, and an arena too small for so many contacts."""
    boxes = "".join(
        f'<body name="b{i}" pos="{3 + 0.3 * (i % 5)} {0.3 * (i // 5)} -3"><freejoint/>'
        '<geom type="box" size="0.1 0.1 0.1" mass="20"/></body>'
        for i in range(25)
    )
    floor = '<geom name="floor" type="plane" size="20 20 .1" pos="0 0 -10"/>'
    model = (MODELS / "cube.xml").read_text()
    model = model.replace("<worldbody>", '<size memory="60k"/><worldbody>', 1)
    (tmp_path / "crowded.xml").write_text(model.replace("</worldbody>", f"{floor}{boxes}</worldbody>"))
    (tmp_path / "crowded.yaml").write_text(HELIX.read_text().replace("../models/cube.xml", "crowded.xml"))
    return tmp_path / "crowded.yaml"


@pytest.mark.flight
def test_both_loops_break_off_alike(crowded, monkeypatch):
    ended, flown = [], []
    take_over = loop.take_over
    monkeypatch.setattr(loop, "take_over", lambda part, *others: flown.append(part.ticks) or take_over(part, *others))
    for compiled in (True, False):
        flight = Flight(crowded, SHORT)
        with monkeypatch.context() as patch:
            if not compiled:
                patch.setattr(loop, "begin_ticks", lambda *_: None)
            flight.fly_to_its_end()
        assert sum(flown) == (flight.tick if compiled else 0)
        flown.clear()
        ended.append((flight.tick, flight.ended, flight.log, {k: v.tobytes() for k, v in flight.signals.items()}))
        assert flight.over
        flight.reset()
        assert not flight.ended
        assert flight.fly(20).time_s == pytest.approx(0.4)
        flown.clear()
    assert ended[0] == ended[1]
    tick, why, log, _ = ended[0]
    assert 50 < tick < 100
    assert why.startswith("MuJoCo cannot go on: mj_stackAlloc: out of memory")
    assert "\n" not in why
    assert log[-1].text == f"{why}: the run ends here"


@pytest.mark.flight
def test_what_was_flown_until_then_is_recorded(crowded, tmp_path):
    run = cube_sim.run(crowded, SHORT, tmp_path / "run")
    assert run.verdict == "ERROR"
    assert run.ended_early is not None
    assert run.ended_early.reason.startswith("MuJoCo cannot go on: ")
    recording = read_recording(run.directory / "run.mcap")
    assert recording.complete
    assert recording.signals["pose.position"][-1, 0] == pytest.approx(run.simulated_s - 0.02)
    assert recording.log[-1].text == f"{run.ended_early.reason}: the run ends here"


@pytest.mark.flight
def test_others_fly_on(crowded):
    """Neither a flight beside one that breaks off, nor the same process afterwards, knows of it."""
    one, other = cube_sim.fly_many(crowded, [SHORT, {**SHORT, "model": str(MODELS / "cube.xml")}], threads=2)
    assert one.verdict == "ERROR"
    assert other.ended_early is None


def test_errors_of_python_calls_stay_exceptions(crowded):
    cube_sim.install()
    text = crowded.with_suffix(".xml").read_text()
    with pytest.raises(ValueError, match="out of memory"):
        mujoco.MjModel.from_xml_string(text.replace('memory="60k"', 'memory="5k"'))
