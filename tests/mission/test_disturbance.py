"""Events that push a vehicle: closed forms of what they do, and the record of them."""

from __future__ import annotations

import numpy as np
import pytest
from support.both_loops import assert_same_flight
from support.places import CUBE, HELIX
from support.scenario_files import MINIMAL, mistakes, write

import cube_sim
from cube_sim.errors import ModelError, ScenarioError
from cube_sim.mission import prepare
from cube_sim.scenario import load
from cube_sim.vehicle.laws.push import mean_share, share_at
from cube_sim.vehicle.loading import load_model
from cube_sim.vehicle.pushes import Push, push_table, set_push
from cube_sim.vehicle.vehicle import Vehicle

MASS, ADDED = 125.0, 79.8
FREE = f"""\
schema_version: 1
name: pushed
model: {CUBE}
duration_s: 4
path: {{type: point, position_m: [0, 0, -5]}}
initial: {{position_m: [0, 0, -5]}}
guidance: {{speed_m_s: 0.4}}
parameters:
  hull:centre_of_buoyancy: [0, 0, 0]
  hull:linear_damping: [0, 0, 0, 0, 0, 0]
  hull:quadratic_damping: [0, 0, 0, 0, 0, 0]
checks: [{{kind: allowed_forces}}]
"""
DEAD = {"kind": "thrusters", "at_s": 0, "state": "dead", "thrusters": [f"T{i}" for i in range(1, 9)]}


def flown(folder, *events, **settings):
    """The signals of a hull without thrusters and without drag that is pushed."""
    return cube_sim.run(write(folder, FREE), {"events": [DEAD, *events], **settings}, record="none").signals


@pytest.mark.parametrize("integrator", ["RK4", "implicitfast", "Euler"])
@pytest.mark.parametrize(("start", "lasts", "ramp"), [(1.0, 1.0, 0.0), (1.003, 0.7004, 0.0), (0.5, 2.0, 0.8)])
@pytest.mark.flight
def test_the_momentum_is_the_impulse_wherever_in_a_step_it_sets_in(start, lasts, ramp, integrator, tmp_path):
    """A trapezoid of height F has the impulse F (lasts - ramp), and M + M_A takes it up."""
    event = {"kind": "force", "at_s": start, "for_s": lasts, "over_s": ramp, "force_N": [30.0, 0.0, -12.0]}
    velocity = flown(tmp_path, event, **{"physics.integrator": integrator})["velocity.linear"]
    expected = np.array([30.0, 0.0, -12.0]) * (lasts - ramp) / (MASS + ADDED)
    assert velocity[-1, 1:] == pytest.approx(expected, rel=1e-9, abs=1e-12)


@pytest.mark.flight
def test_a_ramp_moves_the_hull_as_its_integral(tmp_path):
    """While it grows, F t / T / (M + M_A) t / 2 is its velocity, and F t^3 / (6 T (M + M_A)) its way."""
    event = {"kind": "force", "at_s": 1, "over_s": 2, "force_N": [0.0, 40.0, 0.0]}
    signals = flown(tmp_path, event)
    grows = (signals["pose.position"][:, 0] > 1.1) & (signals["pose.position"][:, 0] < 2.9)
    t = signals["pose.position"][grows, 0] - 1.0
    way = 40.0 * t**3 / (6.0 * 2.0 * (MASS + ADDED))
    assert signals["pose.position"][grows, 2] == pytest.approx(way, abs=2e-5)


@pytest.mark.flight
def test_a_force_beside_the_centre_of_mass_turns_the_hull(tmp_path):
    event = {"kind": "force", "at_s": 1, "for_s": 0.1, "force_N": [0.0, 10.0, 0.0], "point_m": [0.2, 0.0, 0.0]}
    signals = flown(tmp_path, event)
    inertia = 5.2083333333333333 + 1.226875
    assert signals["velocity.angular"][-1, 3] == pytest.approx(10.0 * 0.2 * 0.1 / inertia, rel=1e-4)
    torque = {"kind": "force", "at_s": 1, "for_s": 0.1, "torque_N_m": [0.0, 0.0, 2.0]}
    turned = flown(tmp_path, torque)["velocity.angular"]
    assert turned[-1, 1:] == pytest.approx(signals["velocity.angular"][-1, 1:], rel=1e-4, abs=1e-12)


@pytest.mark.flight
@pytest.mark.parametrize(("axes", "along"), [("world", [1, 0, 0]), ("body", [0, 1, 0])])
def test_axes_are_the_worlds_or_the_bodys(axes, along, tmp_path):
    """The vehicle heads along y."""
    event = {"kind": "force", "at_s": 0.5, "force_N": [20.0, 0.0, 0.0], "axes": axes}
    signals = flown(tmp_path, event, **{"initial.attitude_deg": [0.0, 0.0, 90.0]})
    moved = signals["pose.position"][-1, 1:] - [0, 0, -5]
    assert moved / np.linalg.norm(moved) == pytest.approx(np.array(along, float), abs=1e-9)
    in_body = [0.0, -20.0, 0.0] if axes == "world" else [20.0, 0.0, 0.0]
    assert signals["disturbance.force"][-1, 1:] == pytest.approx(in_body, abs=1e-12)
    assert not signals["disturbance.force"][:25, 1:].any()


@pytest.mark.flight
def test_the_disturbance_observer_finds_what_the_record_has(tmp_path):
    event = {"kind": "force", "at_s": 2, "over_s": 1, "force_N": [12.0, -5.0, 8.0], "point_m": [0.1, 0.0, 0.1]}
    settings = {"events": [event], "duration_s": 15.0, "control.current_time_s": None}
    signals = cube_sim.run(write(tmp_path, FREE), settings, record="none").signals
    true = np.concatenate([signals["disturbance.force"][-1, 1:], signals["disturbance.torque"][-1, 1:]])
    assert true[:3] == pytest.approx([12.0, -5.0, 8.0], abs=0.2)
    assert signals["wrench.disturbance"][-1, 1:] == pytest.approx(true, abs=0.05)


@pytest.mark.flight
def test_both_loops_are_pushed_the_same(monkeypatch):
    events = [
        {"kind": "force", "at_s": 1.003, "for_s": 2.0, "over_s": 0.5, "force_N": [30.0, 0.0, 10.0], "axes": "body"},
        {"kind": "force", "name": "a shove", "at_s": 2, "for_s": 0.015, "torque_N_m": [0.0, 5.0, 5.0]},
        {"kind": "force", "at_s": 3, "force_N": [0.0, -6.0, 0.0], "site": "T3"},
    ]
    settings = {"events": events, "duration_s": 6.0, "checks": [{"kind": "allowed_forces"}]}
    assert assert_same_flight(HELIX, settings, monkeypatch) > 0.9


def test_mean_and_share_agree(tmp_path):
    times = (1.0, 1.5, 2.5, 3.0)
    for t in np.linspace(0.0, 4.0, 401):
        mean = np.mean([share_at(t + (k + 0.5) / 1000 * 0.2 - 0.1, *times) for k in range(1000)])
        if t > 0.1:
            assert mean_share(float(t), 0.2, *times) == pytest.approx(mean, abs=1e-4)
    assert mean_share(0.0, 0.2, 0.05, 0.05, 9.0, 9.0) == pytest.approx(0.5)


def test_a_model_without_room_is_not_pushed():
    model = load_model(CUBE)
    assert push_table(model) is None
    with pytest.raises(ModelError, match="room for 0 pushes"):
        set_push(model, 0, Vehicle.from_model(model).body, Push(force=(1.0, 0.0, 0.0)))
    with pytest.raises(ModelError, match="is no hull"):
        set_push(load_model(CUBE, pushes=1), 0, 0, Push())


def test_a_site_of_something_else_is_refused_in_place(tmp_path):
    event = {"kind": "force", "at_s": 1, "force_N": [1.0, 0.0, 0.0], "site": "nose"}
    with pytest.raises(
        ScenarioError, match=r"override events: events\.0\.site: the hull 'hull' has no site 'nose'; it has imu, T1"
    ):
        prepare(load(write(tmp_path, FREE), {"events": [event]}))


@pytest.mark.parametrize(
    ("event", "expected"),
    [
        ("at_s: 1", "events.0.force_N: give force_N, torque_N_m or both"),
        ("at_s: 1, force_N: [1, 0, 0], for_s: 1, over_s: 0.6", "events.0.over_s: must be at most half of for_s, 1 s"),
        ("at_s: 1, force_N: [1, 0, 0], site: a, point_m: [0, 0, 0]", "events.0.site: give either point_m or site"),
    ],
)
def test_what_is_no_push_is_refused_in_place(event, expected, tmp_path):
    (found,) = mistakes(write(tmp_path, MINIMAL + f"events: [{{kind: force, {event}}}]\n"))
    assert expected in found
