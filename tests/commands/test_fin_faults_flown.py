"""Single faults of fins, flown: what the others hold, what nobody does, and what the terminal says of it."""

from __future__ import annotations

import json

import mujoco
import numpy as np
import pytest
from support.finned import x_tail
from support.places import MODELS
from typer.testing import CliRunner

import cube_sim
from cube_sim.commands.cli import app
from cube_sim.commands.fin_faults_flown import FinFault, every_fin_fault, fin_cases
from cube_sim.commands.stuck_flight import ReadModel
from cube_sim.control.authority import Authority

pytestmark = pytest.mark.flight

SPEED = 1.5


@pytest.fixture
def finned(tmp_path):
    """A torpedo with four fins at 45 degrees, and its file."""
    file = tmp_path / "x_tail.xml"
    file.write_text(x_tail())
    return file


def cases_of(file, faults, **given):
    model = cube_sim.load_model(file)
    return fin_cases(cube_sim.Vehicle.from_model(model), SPEED, ReadModel(file, model), faults=faults, **given)


def test_every_fin_is_loose_and_jammed_four_times(finned):
    vehicle = cube_sim.Vehicle.from_model(cube_sim.load_model(finned))
    faults = every_fin_fault(vehicle, gone=("x2",))
    assert [fault.fin for fault in faults] == [name for name in ("x1", "x3", "x4") for _ in range(5)]
    assert [fault.angle_rad for fault in faults[:5]] == [None, -0.175, 0.175, -0.35, 0.35]


def test_three_fins_of_an_x_tail_keep_a_course_and_one_pair_does_not(finned):
    loose, little, far = cases_of(finned, [FinFault("x1"), FinFault("x3", 0.1), FinFault("x3", 0.35)])
    for case in (loose, little):
        assert case.keeps
        assert not case.reason
        assert case.authority is not Authority.SAFE
        assert case.off_m < 0.01
        assert case.speed_m_s == pytest.approx(SPEED, abs=0.02)
    assert far.farthest_m > 2.0 * little.farthest_m > 0.0
    (none,) = cases_of(finned, [FinFault("x1")], lost=("x2", "x3", "x4"))
    assert not none.keeps
    assert none.reason


def test_it_is_the_flight_of_a_scenario_that_says_the_same(finned):
    (case,) = cases_of(finned, [FinFault("x3", 0.1)])
    flight = cube_sim.Flight(
        {
            "schema_version": 1,
            "name": "the_same",
            "model": str(finned),
            "duration_s": 80,
            "path": {"type": "line", "start_m": [0, 0, -20], "end_m": [1500, 0, -20]},
            "initial": {"position_m": [0, 0, -20], "velocity_m_s": [SPEED, 0, 0]},
            "guidance": {"speed_m_s": SPEED},
            "control": {"faults": "told"},
            "events": [
                {"kind": "fins", "at_s": 20, "fins": ["x3"], "state": "jammed", "angle_deg": float(np.degrees(0.1))}
            ],
            "checks": [{"kind": "allowed_forces"}],
        }
    )
    flight.fly_to_its_end()
    rows = flight.signals["path_error.cross_track"]
    assert case.farthest_m == rows[rows[:, 0] >= 20.0, 1].max()
    assert case.off_m == rows[rows[:, 0] >= 65.0, 1].max()


def test_a_changed_model_flies_as_it_is_changed(finned):
    """What --set changes is in the model that is given, not in the file."""
    file, spec = finned, mujoco.MjSpec.from_file(str(finned))
    model = cube_sim.load_model(spec, {"x3:fin_area": 0.03})
    (case,) = fin_cases(cube_sim.Vehicle.from_model(model), SPEED, ReadModel(file, model), faults=[FinFault("x3", 0.1)])
    (before,) = cases_of(file, [FinFault("x3", 0.1)])
    assert case.farthest_m > 1.5 * before.farthest_m


def test_a_rudder_and_a_stern_plane_have_nobody_to_stand_in_for_them(monkeypatch):
    """REMUS 100: the terminal and JSON say with which fin lost no course is kept, and why."""
    from cube_sim.commands import fin_faults_flown

    whole = fin_faults_flown.every_fin_fault
    monkeypatch.setattr(fin_faults_flown, "every_fin_fault", lambda *given: whole(*given)[::5])
    file = str(MODELS / "remus100.xml")
    result = CliRunner().invoke(app, ["analyze", file, "--stuck", "--speed", "1.5"])
    assert result.exit_code == 0
    assert "single faults of fins: 0 of 2 keep the course; flown straight ahead at 1.5 m/s for 60 s" in result.output
    rows = [line.split() for line in result.output.splitlines() if line.startswith(("stern_planes  ", "rudder  "))]
    assert [row[:4] for row in rows] == [["stern_planes", "loose", "SAFE", "no"], ["rudder", "loose", "SAFE", "no"]]
    told = json.loads(CliRunner().invoke(app, ["analyze", file, "--stuck", "--speed", "1.5", "--json"]).output)
    assert [(case["fin"], case["state"], case["follows"]) for case in told["stuck_fins"]] == [
        ("stern_planes", "loose", False),
        ("rudder", "loose", False),
    ]
    assert "cannot turn (yaw)" in told["stuck_fins"][1]["reason"]
