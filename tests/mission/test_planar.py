"""The planar law flying a model: what it knows of the hull, and which scenarios it refuses."""

from __future__ import annotations

import numpy as np
import pytest
from support.places import MODELS, SCENARIOS
from support.planar_flight import INFANTE

import cube_sim
from cube_sim.errors import ModelError, ScenarioError
from cube_sim.mission import prepare
from cube_sim.mission.planar_identification import identify_planar_model
from cube_sim.scenario import load
from cube_sim.vehicle.current import water_velocity

MISSION = f"""\
schema_version: 1
name: planar
model: {MODELS / "infante.xml"}
duration_s: 1
path: {{type: line, start_m: [0, 0, -5], end_m: [40, 0, -5]}}
initial: {{position_m: [0, 3, -5], velocity_m_s: [1, 0.1, 0]}}
guidance: {{speed_m_s: 1.5, stop_at_end: false}}
control: {{law: planar_lapierre_2007}}
checks:
  - {{kind: allowed_forces}}
"""


def vehicle_of(name):
    model = cube_sim.load_model(MODELS / f"{name}.xml")
    return model, cube_sim.Vehicle.from_model(model)


CUSTOM_END = "</custom>"
ADDED_MASS = np.diag([141.9, 1715.4, 300.0, 100.0, 1349.0, 1349.0])
ADDED_MASS[1, 5] = ADDED_MASS[5, 1] = 30.0


def infante_with(changes, folder):
    """Its compiled model with some words of the file changed, and the hull in it."""
    text = (MODELS / "infante.xml").read_text()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    (folder / "hull.xml").write_text(text)
    model = cube_sim.load_model(folder / "hull.xml")
    return model, cube_sim.Vehicle.from_model(model)


def test_the_model_read_off_the_compiled_hull_is_the_published_one():
    model, vehicle = vehicle_of("infante")
    model.opt.wind[:] = [0.3, -0.2, 0.0]  # a current must not get into it, and must stay
    found = identify_planar_model(model, vehicle)
    np.testing.assert_allclose(found, INFANTE, atol=1e-9)
    np.testing.assert_array_equal(model.opt.wind, [0.3, -0.2, 0.0])


def test_a_current_that_varies_with_time_and_depth_is_no_property_of_the_hull(tmp_path):
    table = '<numeric name="water:current" data="0 -9 0.2 0.1 0  0 0 0.3 0 0  60 -9 -0.1 0.2 0  60 0 0.2 0 0"/>'
    model, vehicle = infante_with(((CUSTOM_END, table + CUSTOM_END),), tmp_path)
    before = water_velocity(model, 30.0, -4.5)
    np.testing.assert_allclose(identify_planar_model(model, vehicle), INFANTE, atol=1e-9)
    np.testing.assert_array_equal(water_velocity(model, 30.0, -4.5), before)


def test_kirchhoffs_terms_are_found_in_a_hull_without_lift():
    model, vehicle = vehicle_of("bluerov2_heavy")
    found = identify_planar_model(model, vehicle)
    m = 13.5
    assert found[:3] == pytest.approx((m + 6.36, m + 7.12, 0.37 + 0.222))
    assert (found.m_ur, found.m_vr) == pytest.approx((found.m_u, found.m_v))
    assert found.K_uv == pytest.approx(found.m_v - found.m_u)  # the Munk moment
    assert (found.D_u, found.D_uu, found.D_vv, found.K_rr) == pytest.approx((13.7, 141.0, 217.0, 1.5))


@pytest.mark.parametrize("name", ["jack", "cube"])
def test_a_hull_that_slips_as_fast_as_it_turns_is_refused(name):
    with pytest.raises(ModelError, match="slips sideways as fast as it turns"):
        identify_planar_model(*vehicle_of(name))


MASS = 'inertial pos="0 0 0"'
ADDED = 'data="141.9 1715.4 300 100 1349 1349"'
COUPLED = 'data="' + " ".join(f"{value:g}" for value in ADDED_MASS.ravel()) + '"'
LEVEL_LIFT = 'centre_of_buoyancy" data="0 0 0.05"'
COUPLINGS = {
    ((MASS, 'inertial pos="0.001 0 0"'),): (
        "hull: its centre of mass lies 0.001 m ahead of the body's origin, which couples sway and yaw by 2.23 kg m:"
    ),
    ((MASS, 'inertial pos="-0.02 0.01 0"'),): (
        "hull: its centre of mass lies 0.02 m behind and 0.01 m to port of the body's origin, which couples surge and"
        " yaw by -22.3 kg m, sway and yaw by -44.7 kg m:"
    ),
    ((ADDED, COUPLED),): "hull:added_mass: its added mass is not diagonal, which couples sway and yaw by 30 kg m:",
    ((ADDED, COUPLED), (MASS, 'inertial pos="0.001 0 0"')): (
        "hull: its centre of mass lies 0.001 m ahead of the body's origin and its added mass is not diagonal, which"
        " couples sway and yaw by 32.2 kg m:"
    ),
    ((MASS, 'inertial pos="0 0 -0.05"'), (LEVEL_LIFT, 'centre_of_buoyancy" data="0.01 0 0.05"')): (
        "hull: level and at rest it is pushed: surge by -7.31 N;"
    ),
    (("35.4 0 0 0 0 0", "35.4 1 0 0 0 0"),): "hull: its resistance to surge depends on v|v|,",
}


@pytest.mark.parametrize("changes", COUPLINGS)
def test_what_the_planar_laws_do_not_know_of_a_hull_is_named_with_its_figure_and_the_law_that_does(changes, tmp_path):
    with pytest.raises(ModelError) as caught:
        identify_planar_model(*infante_with(changes, tmp_path))
    assert str(caught.value).startswith(COUPLINGS[changes])
    assert str(caught.value).endswith("; `control.law: motion_6dof` knows it")


@pytest.mark.parametrize(
    "changes", [(("35.4 0 0 0 0 0", "0 0 0 0 0 0"),), ((MASS, 'inertial pos="1e-6 0 0"'),)], ids=["no drag", "rounding"]
)
def test_rounding_is_not_read_as_a_resistance(changes, tmp_path):
    model, vehicle = infante_with(changes, tmp_path)
    drag = 0.0 if "0 0 0 0 0 0" in changes[0][1] else INFANTE.D_uu
    np.testing.assert_allclose(identify_planar_model(model, vehicle), INFANTE._replace(D_uu=drag), atol=0.01)


@pytest.mark.parametrize("name", ["remus100_circle", "remus100_sinusoid", "nps_auv2_line"])
def test_a_vehicle_that_its_fins_steer_is_refused_in_one_line_with_the_remedy(name):
    """Which works: the same path is flown without the key (tests/laws)."""
    with pytest.raises(ScenarioError) as told:
        prepare(load(SCENARIOS / f"{name}.yaml", {"control.law": "planar_lapierre_2007"}))
    (line,) = str(told.value).splitlines()
    assert "fins steer this vehicle, and hold its depth: leave control.law out" in line
    assert prepare(load(SCENARIOS / f"{name}.yaml")).ability.steered_by is not None


def test_the_law_named_takes_the_hull_that_the_planar_law_refuses(tmp_path):
    infante_with(((MASS, 'inertial pos="0.001 0 0"'),), tmp_path)
    path = tmp_path / "mission.yaml"
    path.write_text(MISSION)
    with pytest.raises(ScenarioError, match=r"8:16: control.law: hull: its centre of mass lies 0.001 m ahead"):
        prepare(load(path, {"model": str(tmp_path / "hull.xml")}))
    prepare(load(path, {"model": str(tmp_path / "hull.xml"), "control.law": "motion_6dof"}))


WRONG = {
    (
        "end_m: [40, 0, -5]",
        "end_m: [40, 0, -9]",
    ): "5:7: path: a planar law follows level paths, this one climbs or sinks",
    (", stop_at_end: false", ""): "guidance.stop_at_end: a planar law steers by moving ahead and cannot stop",
    ("planar_lapierre_2007", "planar_lapierre_2007, planar: {least_speed_m_s: 1.5}"): (
        "8:64: control.planar.least_speed_m_s: must lie below the speed wanted everywhere, got 1.5 m/s"
    ),
    ("[0, 3, -5]", "[0, 3, -5.1]"): (
        "6:23: initial.position_m: starts at z = -5.1 m, the path lies at z = -5 m, and nothing the controller asks for"
    ),
    ("lapierre_2007", "lapierre_2007, attitude: {mode: free}"): "control.attitude: the planar law has no use",
    ("lapierre_2007", "lapierre_2007, velocity_time_s: 2"): "control.velocity_time_s: the planar law has no use",
    ("lapierre_2007", "lapierre_2007, safe_mode: {distance_limit_m: 4}"): (
        "control.safe_mode.distance_limit_m: the planar law has no use for it"
    ),
    ("duration_s: 1\n", "duration_s: 9\ncontrol_period_s: 1.5\n"): (
        "control_period_s: 1.5 s is longer than the 1 s that control.planar.yaw_rate_gain_per_s asks for"
    ),
    ("infante.xml", "cube.xml"): "8:16: control.law: hull: slips sideways as fast as it turns",
}


@pytest.mark.parametrize(("old", "new"), WRONG)
def test_what_the_planar_law_cannot_fly_is_refused_at_its_place(old, new, tmp_path):
    path = tmp_path / "mission.yaml"
    path.write_text(MISSION.replace(old, new))
    with pytest.raises(ScenarioError) as caught:
        prepare(load(path))
    (mistake,) = caught.value.mistakes
    assert WRONG[old, new] in mistake


def test_a_circle_run_without_end_needs_no_stop_and_one_with_a_last_lap_may_not_ask_for_it(tmp_path):
    path = tmp_path / "mission.yaml"
    ring = {"path": {"type": "circle", "centre_m": [0, 0, -5], "radius_m": 12}, "guidance.stop_at_end": True}
    path.write_text(MISSION)
    prepare(load(path, ring))
    prepare(load(path, ring | {"path.laps": 1.5, "guidance.stop_at_end": False}))
    with pytest.raises(
        ScenarioError, match=r"guidance.stop_at_end: a planar law .* where the path or its last lap ends"
    ):
        prepare(load(path, ring | {"path.laps": 1.5}))


def test_what_a_saved_scenario_writes_out_of_the_keys_it_has_no_use_for_is_no_mistake(tmp_path):
    path = tmp_path / "mission.yaml"
    path.write_text(MISSION)
    saved = tmp_path / "resolved.yaml"
    saved.write_text(load(path).resolved_yaml())
    assert "velocity_time_s" in saved.read_text()
    prepare(load(saved))


def test_a_corner_out_of_the_plane_is_seen_between_legs_of_any_length(tmp_path):
    """A riser of a metre between two level legs of five kilometres."""
    path = tmp_path / "mission.yaml"
    riser = (
        "{type: polyline, points_m: [[0, 0, -5], [5000, 0, -5], [5001, 0, -4], [9000, 0, -4]], corner_radius_m: 0.5}"
    )
    path.write_text(MISSION.replace("{type: line, start_m: [0, 0, -5], end_m: [40, 0, -5]}", riser))
    with pytest.raises(ScenarioError, match="this one climbs or sinks"):
        prepare(load(path))


@pytest.mark.parametrize(
    ("overrides", "mistake"),
    [
        ({}, None),
        ({"control_period_s": 0.31}, None),  # the loops are as slow as that period asks for
        ({"control_period_s": 0.3, "control.rate_time_s": 0.3}, None),
        (
            {"control_period_s": 0.31, "control.rate_time_s": 0.3},
            "override control_period_s: 0.31 s is longer than the 0.3 s that control.rate_time_s asks for",
        ),
        (
            {"control_period_s": 0.31, "control.rate_time_s": 0.4, "control.attitude_time_s": 0.2},
            "the 0.2 s that control.attitude_time_s asks for: the loop would be unstable",
        ),
        ({"initial.position_m": [0, 3, -5.04]}, None),
        (
            {"initial.position_m": [0, 3, -2]},
            "override initial.position_m: starts at z = -2 m, the path lies at z = -5",
        ),
    ],
)
def test_the_law_for_all_axes_refuses_a_slow_period_and_a_level_vehicle_beside_its_depth(overrides, mistake, tmp_path):
    path = tmp_path / "mission.yaml"
    path.write_text(MISSION.replace("infante", "jack").replace("planar_lapierre_2007", "motion_6dof"))
    loaded = load(path, {"duration_s": 10, **overrides})
    if mistake is None:
        prepare(loaded)
        return
    with pytest.raises(ScenarioError) as caught:
        prepare(loaded)
    (line,) = caught.value.mistakes
    assert mistake in line


@pytest.mark.flight
def test_the_controller_asks_for_force_ahead_and_torque_only_and_says_so(tmp_path):
    path = tmp_path / "mission.yaml"
    path.write_text(MISSION)
    run = cube_sim.run(path, out=tmp_path / "out")
    assert run.verdict == "PASS"
    demanded = run.signals["wrench.demanded"][:, 1:]
    np.testing.assert_array_equal(demanded[:, 1:5], 0.0)
    assert np.abs(demanded[:, [0, 5]]).min(axis=0).max() > 0.0
    # attitude_error is |psi - delta|, from the recorded pose and velocity alone
    q, v = run.signals["pose.quaternion"][:, 1:], run.signals["velocity.linear"][:, 1:]
    psi = 2.0 * np.arctan2(q[:, 3], q[:, 0]) + np.arctan2(v[:, 1], v[:, 0])
    delta = -np.radians(60.0) * np.tanh(0.5 * run.signals["pose.position"][:, 2])
    np.testing.assert_allclose(run.signals["path_error.attitude"][:, 1], np.abs(psi - delta), atol=1e-9)


@pytest.mark.flight
def test_beyond_the_end_of_a_path_it_runs_on_straight(tmp_path):
    path = tmp_path / "mission.yaml"
    bend = "{type: arc, start_m: [0, 3, -5], through_m: [10, 5, -5], end_m: [16, 13, -5]}"
    path.write_text(
        MISSION.replace("{type: line, start_m: [0, 0, -5], end_m: [40, 0, -5]}", bend).replace(
            "duration_s: 1\n", "duration_s: 40\n"
        )
    )
    run = cube_sim.run(path, out=tmp_path / "out")
    late = run.signals["pose.position"][-250:, 1:]
    course = np.diff(late[:, :2], axis=0)
    angles = np.unwrap(np.arctan2(course[:, 1], course[:, 0]))
    assert np.ptp(angles) < 0.01
    assert run.signals["velocity.linear"][-1, 1] == pytest.approx(1.5, abs=0.01)
    assert run.signals["target.remaining"][-1, 1] == 0.0
    assert run.signals["path_error.lateral"][-1, 1] == pytest.approx(0.0, abs=0.01)
