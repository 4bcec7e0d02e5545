"""The beginning of a flight."""

from __future__ import annotations

import copy
from pickle import PicklingError
from typing import Any

import mujoco
import numpy as np

from cube_sim.errors import CubeSimError, FlightError
from cube_sim.flight.compiled import compile_beside, wait_for_loop
from cube_sim.mission import Mission, prepare
from cube_sim.mission.copying import packed, unpacked
from cube_sim.mission.fin_response import record_fin_health
from cube_sim.mission.first_warnings import first_warnings
from cube_sim.mission.fleet import FleetMission, prepare_fleet
from cube_sim.mission.hull import CompiledHull, initial_state, set_physics
from cube_sim.mission.own.given import NOT_AGAIN, why_not_again
from cube_sim.mission.prepare import mission_of
from cube_sim.mission.way_of_flying import way_of_flying
from cube_sim.native.forked import flying, require_its_own_threads
from cube_sim.recording.signal_store import SignalStore
from cube_sim.scenario import Loaded
from cube_sim.scenario.fleet_loading import LoadedFleet
from cube_sim.spatial import State, Vector, rotation_from_quaternion
from cube_sim.vehicle.mjcf.time_step import require_time_step
from cube_sim.vehicle.vehicle import Vehicle


def prepared(loaded: Loaded) -> Mission:
    """A mission built; where there is no machine code yet, by what other processes compile first.

    Raises:
        ScenarioError: the model does not fit the scenario; with position.
        FlightError: this process was forked off while threads of its parent flew.
    """
    require_its_own_threads()
    with flying():
        compile_beside()
        wait_for_loop()
        return prepare(loaded)


def prepared_hull(loaded: Loaded, model: mujoco.MjModel, hull: str) -> Mission:
    """The same of a hull whose model is compiled already, on a copy of that.

    Args:
        loaded: what it flies; its file's own model is not looked at.
        model: made by `load_model`.
        hull: its name.

    Raises:
        ScenarioError: the model does not fit the scenario; with position.
        ModelError: its lags are too short for the scenario's time step.
    """
    require_its_own_threads()
    with flying():
        compile_beside()
        wait_for_loop()
        own = copy.copy(model)
        set_physics(own, loaded.scenario)
        require_time_step(own)
        flown = CompiledHull(own, Vehicle.from_model(own, hull))
        return mission_of(loaded, flown, flown, initial_state(*flown, loaded.scenario))


def prepared_fleet(loaded: LoadedFleet) -> FleetMission:
    """The missions of several vehicles built, as `prepared`."""
    require_its_own_threads()
    with flying():
        compile_beside()
        wait_for_loop()
        return prepare_fleet(loaded)


def described(mission: Mission, store: SignalStore) -> None:
    """Record what a reader must know before the first row."""
    points = mission.outline
    store.append("path", 0.0, points.ravel())
    for warning in first_warnings(mission):
        store.log(0.0, "WARNING", warning)
    length = mission.path.length
    store.log(0.0, "INFO", f"{mission.scenario.name}: {f'{length:.2f} m of path' if length else 'a point to hold'}")
    for key, code in mission.codes.items():
        store.log(0.0, "INFO", f"{key}: {code.name}, SHA-256 {code.digest}")
        if reason := why_not_again(code):
            store.log(0.0, "WARNING", f"{key}: {code.name} {NOT_AGAIN}: {reason}")
    store.log(0.0, "INFO", way_of_flying(mission.ability))
    record_fin_health(mission, store, 0.0)
    tell_phase(mission, store, 0.0)


def tell_phase(mission: Mission, store: SignalStore, t: float) -> None:
    """Record which phase begins at t [s], and say so, where the mission has phases."""
    if mission.phases:
        record_phase(mission, store, t)
        store.log(t, "INFO", mission.phases.title)


def record_phase(mission: Mission, store: SignalStore, t: float) -> None:
    """Record which phase is flown at t [s], and how many ran out of time before, where one can."""
    phases = mission.phases
    store.append("phase", t, float(phases.index), *((float(phases.run_out),) if phases.timed else ()))


def checked_seed(seed: Any) -> int:
    """A root of random streams, as a scenario has it.

    Raises:
        FlightError: it is none.
    """
    if isinstance(seed, int | np.integer) and 0 <= seed < 2**63:
        return int(seed)
    raise FlightError(f"seed is {seed!r}; it takes a whole number from 0 to 2^63 - 1")


def pose_numbers(state: Any) -> Vector:
    """Position (3,), quaternion (4,) of length one, velocity (3,) and rates (3,) of a state, (13,).

    Raises:
        FlightError: it is none, is not finite, or its quaternion has no direction.
    """
    parts = []
    for name, width in (("position", 3), ("quaternion", 4), ("velocity", 3), ("rates", 3)):
        try:
            part = np.array(getattr(state, name), dtype=np.float64)
        except (AttributeError, TypeError, ValueError):
            raise FlightError(f"state takes a State, whose {name} is {width} numbers, not {state!r:.60}") from None
        if part.shape != (width,):
            raise FlightError(f"the state's {name} has shape {part.shape}; it takes {width} numbers")
        parts.append(part)
    size = float(np.linalg.norm(parts[1]))
    if not np.isfinite(np.concatenate(parts)).all() or not size > 0.0:
        raise FlightError("the state must be finite numbers, its quaternion other than zero")
    parts[1] /= size
    return np.concatenate(parts)


def placed(mission: Mission, pose: Vector) -> None:
    """Put the vehicle into a state; everything else is as at the beginning.

    Args:
        mission: at its beginning.
        pose: (13,) of `pose_numbers`.
    """
    data, at, dof = mission.data, mission.vehicle.qpos_address, mission.vehicle.dof_address
    data.qpos[at : at + 7] = pose[:7]
    data.qvel[dof : dof + 3] = rotation_from_quaternion(pose[3:7]) @ pose[7:10]
    data.qvel[dof + 3 : dof + 6] = pose[10:]


def foreseen_attitude(mission: Mission, state: State) -> Vector:
    """The attitude (4,) wxyz a copy of the controller asks for in a state; the state's where it has none to copy."""
    try:
        controller = unpacked(packed(mission.controller, mission.fixed), mission.fixed)
        period = mission.scenario.control_period_s
        return controller.decide(state, np.zeros(6), period, mission.force_ratio).quaternion
    except (PicklingError, TypeError, AttributeError, CubeSimError):
        return np.asarray(state.quaternion)
