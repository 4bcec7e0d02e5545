"""Ballast let go: how hard it lifts, and what it does to the energy of a hull at the surface."""

import mujoco
import numpy as np
import pytest
from support.edited_cube import edited
from support.flights import FORCES_ONLY, thruster_event
from support.places import SCENARIOS

import cube_sim
from cube_sim import Vehicle, load_model
from cube_sim.mission.drop_weight import EMERGING_M, DropWeight

SURFACE = -4.0
UNDAMPED = (
    ('damping" data="5 5 5 0.5 0.5 0.5"', 'damping" data="0 0 0 0 0 0"'),
    ('damping" data="131.25 131.25 131.25 1.0 1.0 1.0"', 'damping" data="0 0 0 0 0 0"'),
)


def spring_energy(depth, weight):
    """U [J] of the force weight * clip(depth / EMERGING_M, -1, 1): what the float would give back."""
    d = abs(depth)
    inside = 0.5 * weight * d**2 / EMERGING_M
    return inside if d <= EMERGING_M else weight * (d - 0.5 * EMERGING_M)


def bobbing(start, weight, period_s, seconds, centre="0 0 0", rates=(0.0, 0.0, 0.0)):
    """Heights of the centre of mass, lifts and energies [J] of a drag-free CUBE at the starts of the ticks."""
    placed = (
        ('inertial pos="0 0 0"', f'inertial pos="{centre}"'),
        ('centre_of_buoyancy" data="0 0 0.02"', f'centre_of_buoyancy" data="{centre}"'),
    )
    model = load_model(edited(*UNDAMPED, *placed))
    model.opt.timestep = period_s / 4
    vehicle = Vehicle.from_model(model)
    ballast = DropWeight(weight, SURFACE, vehicle, period_s)
    assert ballast.drop()
    data = mujoco.MjData(model)
    data.qpos[:7] = 0.0, 0.0, start, 1.0, 0.0, 0.0, 0.0
    data.qvel[3:6] = rates
    mass = vehicle.mass_matrix + vehicle.added_mass
    heights, lifts, energies = [], [], []
    for _ in range(round(seconds / period_s)):
        mujoco.mj_forward(model, data)
        ballast.lift(data)
        R = data.xmat[vehicle.body].reshape(3, 3)
        nu = np.concatenate([data.qvel[:3] @ R, data.qvel[3:6]])
        height = data.xipos[vehicle.body, 2]
        heights.append(height)
        lifts.append(data.xfrc_applied[vehicle.body, 2])
        energies.append(0.5 * nu @ mass @ nu + spring_energy(SURFACE - height, weight))
        mujoco.mj_step(model, data, nstep=4)
    return np.array(heights), np.array(lifts), np.array(energies)


@pytest.mark.parametrize("period_s", [0.02, 0.1])
@pytest.mark.parametrize("weight", [15.0, 400.0, 20000.0])
@pytest.mark.parametrize("start", [-5.0, -4.02, -3.9, -3.0])
def test_a_hull_without_drag_comes_to_rest_at_the_surface_and_never_gains_energy(start, weight, period_s):
    heights, lifts, energies = bobbing(start, weight, period_s, 40.0)
    assert np.abs(lifts).max() <= weight
    assert np.all(np.diff(energies) <= 1e-9 * energies.max())
    np.testing.assert_allclose(heights[-10:], SURFACE, atol=1e-3)


def test_a_hull_that_turns_while_it_is_lifted_off_its_origin_gains_no_energy():
    """It has no righting moment: the centre of mass lies in the centre of buoyancy, 10 cm from the origin."""
    heights, _, energies = bobbing(-4.5, 400.0, 0.02, 30.0, centre="0.1 0 0.02", rates=(0.0, 1.0, 0.3))
    assert energies[-1] < 0.5 * energies[0]
    assert np.all(np.diff(energies) <= 1e-4 * energies.max())
    np.testing.assert_allclose(heights[-100:], SURFACE, atol=0.02)


def test_ballast_goes_once_and_only_where_there_is_some():
    model = load_model(edited())
    vehicle, data = Vehicle.from_model(model), mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    ballast = DropWeight(15.0, 3.0, vehicle, 0.02)
    ballast.lift(data)
    assert not data.xfrc_applied.any()
    assert ballast.drop()
    assert not ballast.drop()
    ballast.lift(data)
    np.testing.assert_array_equal(data.xfrc_applied[vehicle.body], [0.0, 0.0, 15.0, 0.0, 0.0, 0.0])
    assert not DropWeight(0.0, 3.0, vehicle, 0.02).drop()


@pytest.mark.flight
@pytest.mark.parametrize("surface_m", [-20.0, -7.0])
def test_wherever_the_surface_is_the_hull_is_no_faster_than_its_drag_allows_for_the_ballast(surface_m, tmp_path):
    changes = {
        "duration_s": 60,
        "events": [thruster_event(5, [f"T{i}" for i in range(1, 9)])],
        "control.safe_mode.surface_m": surface_m,
        "checks": FORCES_ONLY,
    }
    run = cube_sim.run(SCENARIOS / "cube_surface.yaml", changes, out=tmp_path)
    height, speed = run.signals["pose.position"][:, 3], np.gradient(run.signals["pose.position"][:, 3], 0.02)
    terminal = np.roots([131.25, 5.0, -15.0]).max()  # [m/s], 15 N against the CUBE's drag
    assert np.abs(speed[500:]).max() <= 1.01 * terminal
    assert height[-1] < height[500] if surface_m < -8.0 else height[-1] == pytest.approx(surface_m, abs=0.01)
