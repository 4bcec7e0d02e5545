"""One vehicle on one mission, flown on from the same moment with each thruster in turn dead or stuck.

The law flies beside two foils in the same water, from where each of them has come by itself: a plain PID behind a
clipped pseudo-inverse that knows of no fault, and nothing at all, every thruster off that is not stuck.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import mujoco
import numpy as np
from support.catalogue.drawn import drawn_layout
from support.catalogue.mjcf import mjcf
from support.catalogue.vehicles import catalogue

from flights.ability import ability_of
from flights.paths import CENTRE_M, drawn_path

Row = dict[str, Any]

SETTLED_S = {True: 15.0, False: 35.0}
"""When the fault comes: after less time where all components are the vehicle's own."""
FLOWN_S = 40.0
"""From the fault on."""
REST_S = 10.0
"""At the end, over which it is judged where the vehicle has come to."""
HELD_M = 0.5
"""A flight that ends within this is held."""
KP, KI, KD = 1.0, 0.15, 1.6
"""Of the foil: accelerations for errors of place and attitude [1/s^2, 1/s^3, 1/s], the same for every hull."""
WOUND_M_S = 1.0
"""Bound on its integral, for places and attitudes alike [m s, rad s]."""


class Fault(NamedTuple):
    """What becomes of a thruster: dead, or stuck at a force [N], half of a limit, a limit or one that is drawn."""

    thruster: int
    kind: str
    force_N: float | None = None  # noqa: N815 - N is the newton


@dataclass(frozen=True)
class Task:
    """A vehicle and what it is told.

    Attributes:
        vehicle: a name of the catalogue, or "fresh<m>_<seed>" for a layout drawn anew.
        path: "line" or "point", or any of `flights.paths.PATHS`.
        seed: of what is drawn: the path, speed, current and forces; None for still water and all limits.
    """

    vehicle: str
    path: str
    seed: int | None = None


def flown(task: Task, out: Path, foils: bool) -> list[Row]:
    """Every fault of a task: rows of what was foreseen and what came of it."""
    from cube_sim.flight import Flight

    folder = out / f"{task.vehicle}_{task.path}{'' if task.seed is None else f'_{task.seed}'}"
    folder.mkdir(parents=True, exist_ok=True)
    model = folder / "model.xml"
    lost, planar, text = _made(task.vehicle)
    model.write_text(text)
    able = ability_of(model, lost, planar)
    if task.path == "point" and not able.stands:
        return []
    scenario, speed = _scenario(task, able, model, planar)
    settled = SETTLED_S[able.full and able.stands]
    flight = Flight(scenario)
    law = _Law(flight, settled)
    flights: dict[str, Any] = {"law": law}
    if foils:
        flights |= {"pid": _Pid(scenario, settled)}
    if foils and task.path == "point":
        flights |= {"off": _Off(law)}
    rows, faults = [], _faults(task, able)
    for fault, case in zip(faults, _foreseen(law, model, faults, lost, speed), strict=True):
        expected = case.transient_at_rest if task.path == "point" else case.transient
        ahead = case.foreseen_at_rest if task.path == "point" else case.foreseen
        row: Row = {
            "vehicle": task.vehicle,
            "path": task.path,
            "seed": task.seed,
            "thruster": able.names[fault.thruster],
            "force_N": fault.force_N,
            "kind": fault.kind,
            "speed_m_s": speed,
            "current_m_s": scenario["current_m_s"],
            "start_m": law.start_m,
            "follows": case.follows,
            "why_not": case.reason,
            "bound_m": expected.bound_m,
            "no_bound": expected.reason,
            "foreseen_m": None if ahead is None else ahead.farthest_m,
            "with_margin_m": None if ahead is None else ahead.with_margin_m,
            "rest_m_s": min(case.rest_m_s, case.alone_m_s),
        }
        for name, each in flights.items():
            error, found = each.beside(fault)
            late = error[error[:, 0] >= settled + FLOWN_S - REST_S, 1]
            row |= {
                f"{name}_worst_m": float(np.max(error[:, 1], initial=0.0)),
                f"{name}_end_m": float(np.mean(late)) if len(late) else np.inf,
                f"{name}_drift_m_s": float(late[-1] - late[0]) / REST_S if len(late) else np.inf,
            }
            if found is not None:
                row |= found
        row["held"] = bool(row["law_end_m"] <= HELD_M)
        row["within"] = bool(row["law_worst_m"] <= expected.bound_m + law.start_m)
        rows.append(row)
    return rows


def _foreseen(law: _Law, model: Path, faults: list[Fault], lost: tuple[str, ...], speed: float):
    """What ``cube-sim analyze --stuck`` says of each fault beforehand."""
    from cube_sim.commands.stuck_flight import ReadModel
    from cube_sim.commands.stuck_report import Fault as Asked
    from cube_sim.commands.stuck_report import fault_cases

    vehicle = law.mission.vehicle
    names, read = vehicle.thrusters.names, ReadModel(model, law.mission.model)
    asked = [Asked(names[f.thruster], f.force_N) for f in faults]
    return fault_cases(vehicle, speed, faults=asked, lost=lost, read=read)


def _made(vehicle: str) -> tuple[tuple[str, ...], bool, str]:
    """Lost thrusters, whether for the plane, MJCF text."""
    if vehicle.startswith("fresh"):
        m, seed = (int(part) for part in vehicle.removeprefix("fresh").split("_"))
        return (), False, mjcf(vehicle, drawn_layout(seed, m))
    entry = catalogue()[vehicle]
    return entry.lost, entry.planar, entry.make()


def _faults(task: Task, able) -> list[Fault]:
    """Each thruster dead, stuck at half of either limit and at the limits; or stuck at a force that is drawn."""
    rng = None if task.seed is None else np.random.default_rng([41, task.seed])
    faults = []
    for i, (low, _, _, high) in enumerate(able.limits):
        if rng is None:
            faults.append(Fault(i, "dead"))
            for kind, share in (("half", 0.5), ("limit", 1.0)):
                faults += [Fault(i, kind, float(share * x)) for x in (low, high) if x != 0.0]
        elif rng.random() < 0.2:
            faults.append(Fault(i, "dead"))
        else:
            faults.append(Fault(i, "drawn", float(rng.uniform(low, high))))
    return faults


def _scenario(task: Task, able, model: Path, planar: bool) -> tuple[dict[str, Any], float]:
    speed, current = float(np.clip(0.5 * able.top_m_s, 0.1, 0.3)), np.zeros(3)
    centre, attitude = np.array(CENTRE_M), 0.0
    settled = SETTLED_S[able.full and able.stands]
    path: dict[str, Any] = {"type": "point", "position_m": [*CENTRE_M], "heading_deg": 0.0}
    start = centre
    if task.seed is not None:
        rng = np.random.default_rng([40, task.seed])
        speed = float(np.clip(rng.uniform(0.2, 0.6) * able.top_m_s, 0.1, 0.6))
        azimuth = rng.uniform(-np.pi, np.pi)
        strength = rng.uniform(0.0, 0.4) * min(speed, able.any_way_m_s)
        current = strength * np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
        radius = max(2.0, 2.0 * able.length_m, 9.0 * speed)
        path, start, attitude, _ = drawn_path(rng, task.path, 1.4 * speed * (settled + FLOWN_S), radius, 0.15)
    elif task.path == "line":
        path = {"type": "line", "start_m": [*centre], "end_m": [float(centre[0] + 2.0 * speed * 90.0), *centre[1:]]}
    moving = 0.0 if task.path == "point" else speed
    infante = task.vehicle.startswith("infante")
    more = {"approach_angle_deg": 45.0, "stop_at_end": False} if infante else {}
    return {
        "schema_version": 1,
        "name": f"stuck_{task.path}",
        "model": str(model.resolve()),
        "duration_s": settled + FLOWN_S + 1.0,
        "path": path,
        "initial": {
            "position_m": [float(x) for x in start],
            "attitude_deg": [0.0, 0.0, float(np.degrees(attitude))],
            "velocity_m_s": [moving, 0.0, 0.0],
        },
        "current_m_s": [float(x) for x in current],
        "guidance": {"speed_m_s": speed} | more,
        "allocation": {"method": "search"},
        "checks": [{"kind": "allowed_forces"}],
    }, speed


class _Law:
    """cube_sim's own law, diagnosis and allocation."""

    def __init__(self, flight, settled: float) -> None:
        self._flight, self._settled, self._dt = flight, settled, flight.mission.scenario.control_period_s
        flight.fly(round(settled / self._dt))
        self._snapshot = flight.snapshot()
        self.point = flight.mission.path.length <= 0.0
        self.start_m = float(self._errors(settled - 2.0)[:, 1].max())

    @property
    def mission(self):
        """The objects of the flight."""
        return self._flight.mission

    def restored(self):
        """Its model and data at the moment of the fault."""
        self._flight.restore(self._snapshot)
        return self._flight.mission.model, self._flight.mission.data

    def beside(self, fault: Fault) -> tuple[np.ndarray, Row]:
        """(n,2) times and errors [s, m] from the fault on, and what was said of it."""
        model, _ = self.restored()
        names = self._flight.mission.vehicle.thrusters.names
        _break(model, names[fault.thruster], fault)
        before = len(self._flight.log)
        left = round(FLOWN_S / self._dt)
        seen = self._flight.observation()
        while left > 0 and not seen.over:
            seen = self._flight.fly(min(left, 50))
            left -= 50
        said = [(line.t, line.text) for line in self._flight.log[before:] if line.t >= self._settled]
        found = next((t for t, text in said if text.startswith(names[fault.thruster])), None)
        authority = self._flight.signals["health.authority"]
        return self._errors(self._settled), {
            "found_s": None if found is None else found - self._settled,
            "said": [f"{t - self._settled:.2f} {text}" for t, text in said][:8],
            "authority": int(authority[-1, 1]),
            "gave_up": bool(np.any(authority[authority[:, 0] >= self._settled, 1] == 3)),
        }

    def _errors(self, from_s: float) -> np.ndarray:
        signals = self._flight.signals
        rows = signals["path_error.cross_track"]
        error = np.abs(rows[:, 1])
        if self.point:
            error = np.hypot(error, signals["path_error.along"][:, 1])
        return np.column_stack([rows[:, 0], error])[rows[:, 0] >= from_s]


class _Foil:
    """MuJoCo stepped from the fault on, with commands of its own."""

    def __init__(self, mission, settled: float) -> None:
        self._mission, self._settled = mission, settled
        self._model, self._vehicle = mission.model, mission.vehicle
        self._dt, self._steps = mission.scenario.control_period_s, mission.scenario.steps_per_tick
        path, self._point = mission.path, mission.path.length <= 0.0
        self._s = np.linspace(0.0, path.length, 1 if self._point else 2000)
        self._places = np.array([path.at(s).position for s in self._s])

    def _off_m(self, position: np.ndarray) -> float:
        """How far from the path: from the nearest of its chords."""
        if self._point:
            return float(np.linalg.norm(position - self._places[0]))
        start, chord = self._places[:-1], np.diff(self._places, axis=0)
        along = np.clip(np.sum((position - start) * chord, axis=1) / np.sum(chord**2, axis=1), 0.0, 1.0)
        return float(np.min(np.linalg.norm(start + along[:, None] * chord - position, axis=1)))

    def _flown(self, data: mujoco.MjData, seconds: float, commands) -> np.ndarray:
        at, rows = self._vehicle.qpos_address, []
        for k in range(round(seconds / self._dt)):
            commands(data)
            mujoco.mj_step(self._model, data, nstep=self._steps)
            if k % 5 == 4:
                rows.append((self._settled + (k + 1) * self._dt, self._off_m(data.qpos[at : at + 3])))
        return np.array(rows)


class _Off(_Foil):
    """Nothing: what is stuck pushes alone."""

    def __init__(self, law: _Law) -> None:
        super().__init__(law.mission, law._settled)
        self._law = law

    def beside(self, fault: Fault) -> tuple[np.ndarray, None]:
        self._model, data = self._law.restored()
        thrusters = self._vehicle.thrusters
        _break(self._model, thrusters.names[fault.thruster], fault)
        rest = thrusters.command(np.zeros(len(thrusters.names)))

        def commands(data: mujoco.MjData) -> None:
            data.ctrl[thrusters.actuators] = rest

        return self._flown(data, FLOWN_S, commands), None


class _Pid(_Foil):
    """A PID on place and attitude, accelerations made into forces by the hull's mass, and a clipped pseudo-inverse."""

    def __init__(self, scenario: dict[str, Any], settled: float) -> None:
        from cube_sim.mission import prepare
        from cube_sim.scenario.loading import load_mapping

        super().__init__(prepare(load_mapping(scenario)), settled)
        vehicle = self._vehicle
        A, self._limits = vehicle.actuation_matrix, vehicle.thrusters.limits
        self._inverse, self._mass = np.linalg.pinv(A, rcond=1e-3), vehicle.dynamics.total_mass
        self._speed = 0.0 if self._point else self._mission.scenario.guidance.speed_m_s
        self._summed, self._target = np.zeros(6), 0.0
        data = self._mission.data
        self._flown(data, settled, self._commands)
        self._start = data.qpos.copy(), data.qvel.copy(), data.act.copy(), self._summed.copy(), self._target
        self._packed = self._model.numeric_data.copy()

    def beside(self, fault: Fault) -> tuple[np.ndarray, None]:
        data = mujoco.MjData(self._model)
        self._model.numeric_data[:] = self._packed
        data.qpos[:], data.qvel[:], data.act[:], self._summed, self._target = (np.copy(x) for x in self._start)
        _break(self._model, self._vehicle.thrusters.names[fault.thruster], fault)
        return self._flown(data, FLOWN_S, self._commands), None

    def _commands(self, data: mujoco.MjData) -> None:
        vehicle = self._vehicle
        mujoco.mj_kinematics(self._model, data)
        at, dof = vehicle.qpos_address, vehicle.dof_address
        R = data.xmat[vehicle.body].reshape(3, 3)
        frame = self._mission.path.at(min(float(self._target), self._mission.path.length))
        tangent = frame.rotation[:, 0]
        error = frame.position - data.qpos[at : at + 3]
        # The target waits as ours does: it keeps abreast of the vehicle.
        self._target = max(0.0, self._target + self._dt * (self._speed - 0.5 * float(tangent @ error)))
        heading = np.arctan2(tangent[1], tangent[0]) if not self._point else 0.0
        level = np.array([[np.cos(heading), -np.sin(heading), 0], [np.sin(heading), np.cos(heading), 0], [0, 0, 1.0]])
        turn = 0.5 * sum(np.cross(R[:, k], level[:, k]) for k in range(3))
        velocity, rates = R.T @ data.qvel[dof : dof + 3], data.qvel[dof + 3 : dof + 6]
        off = np.concatenate([R.T @ error, R.T @ turn])
        wanted = np.concatenate([self._speed * R.T @ tangent, np.zeros(3)])
        self._summed = np.clip(self._summed + self._dt * off, -WOUND_M_S, WOUND_M_S)
        pull = KP * off + KI * self._summed + KD * (wanted - np.concatenate([velocity, rates]))
        forces = np.clip(self._inverse @ (self._mass @ pull), self._limits[:, 0], self._limits[:, 3])
        data.ctrl[vehicle.thrusters.actuators] = vehicle.thrusters.command(forces)


def _break(model: mujoco.MjModel, name: str, fault: Fault) -> None:
    from cube_sim.vehicle import faults

    if fault.force_N is None:
        faults.set_efficiency(model, name, 0.0)
    else:
        faults.set_stuck(model, name, fault.force_N)
