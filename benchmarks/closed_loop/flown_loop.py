"""One tick of the real loop as a map: a point of its whole state to the next.

The hull, the water and the lag of the thrusters are MuJoCo's own steps; the controller is the one that a scenario asks
for, with all it remembers. Two things are left out that have no derivative: dead zones and limits of the thrusters.
Their forces are the least squares ones for the wrench demanded.
"""

from __future__ import annotations

import json
from math import atan2
from pathlib import Path
from typing import Any, NamedTuple
from xml.etree import ElementTree

import mujoco
import numpy as np
from numpy.typing import NDArray
from support.catalogue.vehicles import Entry

from closed_loop.condition import Condition
from cube_sim.control.authority import Authority
from cube_sim.control.critical_speed import surely_uncritical_speed
from cube_sim.control.current import CurrentObserver
from cube_sim.control.loop_times import mean_delay
from cube_sim.control.path_follower import PathFollower
from cube_sim.mission.prepare import prepare
from cube_sim.scenario import load
from cube_sim.spatial import Matrix, Vector, quaternion_from_rotation, rotation_about
from cube_sim.vehicle.state import read_state
from cube_sim.wrench.health import Health

STRONGEST_N = 1e5
"""Where the straight characteristic ends; nothing comes near."""
FAR_M = 1000.0
NOTHING = np.zeros(6)
NEVER_S = 1e12
"""Time constant of an estimate that is frozen."""

MEMORIES = (
    ("observer", "memory", ("integral", "estimate")),
    ("", "memory", ("force", "velocity", "torque")),
    ("", "centre", ("shift",)),
    ("balanced", "memory", ("led", "twice", "torque", "torque_twice")),
)
"""What the controller remembers from tick to tick: the part that holds it (the controller itself: none), the name of
its record, and the fields. The centre of oscillation moves only where a hull is dragged along. Beside these the
estimate of the current."""


class Point(NamedTuple):
    """A state of the loop.

    Attributes:
        vectors: position from the target [m], world axes; velocity and rates, body axes; activations of the thrusters;
            the wrench commanded; what the controller remembers, and where joints are and how they move (k,).
        rotations: attitude of the hull, and the desired one where the controller carries it on; each (3,3).
    """

    vectors: Vector
    rotations: tuple[Matrix, ...]

    def moved(self, by: Vector) -> Point:
        """The point after a small step (n,): first the vectors, then three angles [rad] for each rotation."""
        k = len(self.vectors)
        angles = by[k:].reshape(-1, 3)
        return Point(self.vectors + by[:k], tuple(R @ _turn(a) for R, a in zip(self.rotations, angles, strict=True)))

    def step_from(self, other: Point) -> Vector:
        """The step (n,) from another point to this one."""
        turns = [_angles(R.T @ Q) for R, Q in zip(other.rotations, self.rotations, strict=True)]
        return np.concatenate([self.vectors - other.vectors, *turns])


class FlownLoop:
    """A vehicle of the catalogue on a straight level path, or at a point where its speed is 0.

    Attributes:
        period: control period [s].
        controller: of the mission.
        hull: the vehicle as it is.
        actuation: A (6,m) of the thrusters that work, as they are.
    """

    def __init__(
        self, entry: Entry, speed_m_s: float, condition: Condition, folder: Path, control: dict[str, Any] | None = None
    ) -> None:
        """Prepare the mission.

        Args:
            entry: the vehicle.
            speed_m_s: along the path.
            condition: what is known wrongly.
            folder: an empty one to write the mission's files into.
            control: further keys of the scenario's `control` block.
        """
        text = entry.make()
        (folder / "model.xml").write_text(text)
        (folder / "mission.yaml").write_text(json.dumps(_scenario(speed_m_s, condition, control or {})))
        times, pointing = _times(prepare(load(folder / "mission.yaml")).controller, entry)
        (folder / "model.xml").write_text(straight_thrusters(text))
        (folder / "mission.yaml").write_text(json.dumps(_scenario(speed_m_s, condition, times | (control or {}))))
        mission = prepare(load(folder / "mission.yaml"))
        assert isinstance(mission.controller, PathFollower)
        self.controller: PathFollower = mission.controller
        self.controller.pointing_time = pointing
        self.controller.reconfigure(self.controller.capability)
        self.period = mission.scenario.control_period_s
        self._model, self._data, self._vehicle = mission.model, mission.data, mission.vehicle
        self._steps = mission.scenario.steps_per_tick
        self.hull = mission.vehicle.dynamics
        names = mission.vehicle.thrusters.names
        works = np.array([name not in entry.lost for name in names])
        believed = np.where(works, mission.allocator.A, 0.0)
        self.actuation = np.where(works, mission.vehicle.actuation_matrix, 0.0)
        if entry.lost:
            health = Health.whole(len(names))
            for i in np.flatnonzero(~works).tolist():
                health = health.with_thruster(i, 0.0)
            self.controller.reconfigure(mission.ability.left(health))
        self._believed, self._forces = believed, np.linalg.pinv(believed, rcond=1e-9)
        if condition.believed is not None:
            self.controller.current_observer = CurrentObserver(self.controller.loops.dynamics, NEVER_S)
            self.controller.current_observer.estimate[:] = condition.believed
            self.controller.reconfigure(self.controller.capability)  # the parts are looked at anew
        self._along = self.controller.target.view(np.zeros(3), np.zeros(3)).point.rotation[:, 0]
        self._started = 0.5 * FAR_M if speed_m_s > 0.0 else 0.0
        self._memories: list[NDArray[np.float64]] = []
        self._delay = mean_delay(mission.vehicle.thrusters.lag_s, self.period)
        self._through_water = float(np.linalg.norm(np.subtract((speed_m_s, 0.0, 0.0), condition.water)))
        self.start = self._warmed_up(speed_m_s)

    @property
    def authority(self) -> Authority:
        """How the vehicle flies."""
        return self.controller.capability.authority

    def too_fast(self, known_to: float = 0.0) -> bool:
        """Whether its speed through the water is beyond the critical one of hulls that differ by a share from it."""
        left = self.controller.capability
        return self._through_water > surely_uncritical_speed(left, self.hull, self._delay, known_to)

    def tick(self, point: Point, pushed: Vector, dragged: Vector = NOTHING) -> tuple[Point, Vector]:
        """The point one control period later, and the wrench (6,) [N, N m] the controller demanded, body axes.

        Args:
            point: at the beginning.
            pushed: wrench (6,) that the thrusters make beside it unknown to the controller, body axes.
            dragged: wrench (6,) that acts on the hull over the tick, body axes.
        """
        applied = self._write(point)
        state = read_state(self._vehicle, self._data)
        decision = self.controller.decide(state, applied, self.period)
        forces = self._forces @ decision.wrench
        beside = self._forces @ pushed
        actuators = self._vehicle.thrusters.actuators
        self._data.ctrl[actuators] = (forces + beside) / STRONGEST_N
        dof = self._vehicle.dof_address
        self._data.qfrc_applied[dof : dof + 3] = state.rotation @ dragged[:3]
        self._data.qfrc_applied[dof + 3 : dof + 6] = dragged[3:]
        mujoco.mj_step(self._model, self._data, nstep=self._steps)
        mujoco.mj_kinematics(self._model, self._data)
        return self._read(self._believed @ forces), decision.wrench

    def flown(self, duration_s: float) -> Point:
        """Where the loop is after so long [s] from its start."""
        point = self.start
        for _ in range(round(duration_s / self.period)):
            point = self.tick(point, NOTHING)[0]
        return point

    def _warmed_up(self, speed_m_s: float) -> Point:
        """Level at the target, at its speed, after a tick in which the controller has built its memory."""
        self.controller.target.arc_length = self._started
        at, dof = self._vehicle.qpos_address, self._vehicle.dof_address
        place = self.controller.target.view(np.zeros(3), np.zeros(3)).point.position
        self._data.qpos[at : at + 7] = [*place, 1.0, 0.0, 0.0, 0.0]
        self._data.qvel[dof : dof + 3] = speed_m_s * self._along
        mujoco.mj_forward(self._model, self._data)
        wrench = np.zeros(6)
        for _ in range(2):
            wrench = self.controller.decide(read_state(self._vehicle, self._data), np.zeros(6), self.period).wrench
            self.controller.target.arc_length = self._started
        for part, name, fields in MEMORIES:
            owner = getattr(self.controller, part) if part else self.controller
            if owner is not None and (name != "centre" or self.controller.dragged):
                self._memories += [getattr(owner, name)[field][0] for field in fields]
        if self.controller.current_observer is not None:
            self._memories.append(self.controller.current_observer.estimate)
        self._memories += [self._data.qpos[at + 7 :], self._data.qvel[dof + 6 :]]  # joints of an arm
        return self._read(wrench)

    def _read(self, applied: Vector) -> Point:
        state = read_state(self._vehicle, self._data)
        target = self.controller.target.view(np.zeros(3), np.zeros(3)).point.position
        place = state.position - target
        remembered = [memory.flatten() for memory in self._memories]
        vectors = np.concatenate([place, state.velocity, state.rates, self._data.act, applied, *remembered])
        desired = () if self._balanced is None else (self._balanced.memory["rotation"][0].copy(),)
        return Point(vectors, (state.rotation, *desired))

    @property
    def _balanced(self) -> Any:
        return self.controller.balanced

    def _write(self, point: Point) -> Vector:
        """Put everything into a point; returns the wrench commanded over the tick before it."""
        R, data, values = point.rotations[0], self._data, point.vectors
        at, dof, m = self._vehicle.qpos_address, self._vehicle.dof_address, len(data.act)
        self.controller.target.arc_length = self._started
        target = self.controller.target.view(np.zeros(3), np.zeros(3)).point.position
        data.time = 0.0
        data.qpos[at : at + 3] = target + values[:3]
        data.qpos[at + 3 : at + 7] = quaternion_from_rotation(R)
        data.qvel[dof : dof + 3] = R @ values[3:6]
        data.qvel[dof + 3 : dof + 6] = values[6:9]
        data.act[:] = values[9 : 9 + m]
        mujoco.mj_kinematics(self._model, data)
        first = 15 + m
        for memory in self._memories:
            memory[...] = values[first : first + memory.size].reshape(memory.shape)
            first += memory.size
        if self._balanced is not None:
            self._balanced.memory["rotation"][0] = point.rotations[1]
        return values[9 + m : 15 + m].copy()


def _times(controller: Any, entry: Entry) -> tuple[dict[str, float], float]:
    """How fast the loops are with the thrusters as they are: without limits of theirs they would be quicker.

    Returns:
        Keys of `control`, and the time of a loop whose attitude points the thrust [s].
    """
    if not isinstance(controller, PathFollower):
        raise TypeError(f"{entry.name} is flown by another law: {type(controller).__name__}")
    loops = controller.loops
    times = {
        "velocity_time_s": loops.velocity_time,
        "attitude_time_s": loops.attitude_time,
        "rate_time_s": loops.rate_time,
    }
    return times, controller.pointing_time


def straight_thrusters(text: str) -> str:
    """The MJCF text with thrusters whose force is their command times `STRONGEST_N`, without dead zone."""
    root = ElementTree.fromstring(text)
    straight = {
        "thruster_characteristic": f"-1 {-STRONGEST_N:.12g} 0 0 1 {STRONGEST_N:.12g}",
        "thruster_dead_zone": "0 0",
    }
    for numeric in root.iter("numeric"):
        parameter = numeric.get("name", "").rpartition(":")[2]
        if parameter in straight:
            numeric.set("data", straight[parameter])
            numeric.attrib.pop("size", None)
    return ElementTree.tostring(root, encoding="unicode")


def _scenario(speed_m_s: float, condition: Condition, control: dict[str, Any]) -> dict[str, Any]:
    line = {"type": "line", "start_m": [0.0, 0.0, -5.0], "end_m": [FAR_M, 0.0, -5.0]}
    return {
        "schema_version": 1,
        "name": "linearised",
        "model": "model.xml",
        "duration_s": 1.0,
        "path": line if speed_m_s > 0.0 else {"type": "point", "position_m": [0.0, 0.0, -5.0]},
        "initial": {"position_m": [0.0, 0.0, -5.0]},
        "current_m_s": list(condition.water),
        "guidance": {"speed_m_s": speed_m_s or 0.4, "wait_for_thrusters": False},
        "control": {"faults": "ignored", **control},
        "knowledge": {"drag": condition.drag, "added_mass": condition.added_mass, "thrust": condition.thrust},
        "checks": [{"kind": "allowed_forces"}],
    }


def _turn(angles: Vector) -> Matrix:
    size = float(np.linalg.norm(angles))
    return np.eye(3) if size == 0.0 else rotation_about(angles / size, size)


def _angles(R: Matrix) -> Vector:
    """The rotation vector (3,) [rad] of a rotation well below half a turn."""
    odd = 0.5 * np.array([R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]])
    sine = float(np.linalg.norm(odd))
    return odd if sine < 1e-9 else odd * (atan2(sine, 0.5 * (np.trace(R) - 1.0)) / sine)
