"""The compiled loop: so many ticks over the stages, or up to one that has something for Python to do."""

from __future__ import annotations

from math import isfinite, isnan

import numpy as np

from cube_sim.allocation.fin_shares import with_missed
from cube_sim.allocation.responsive import allocate_responsive, limit_thrusters
from cube_sim.control.attitude_mode import DESIRED
from cube_sim.control.diagnosis import enter_pair, speaks_against
from cube_sim.control.following import FOLLOWED
from cube_sim.control.moment_budget import limit_budget
from cube_sim.control.priority import yield_attitude
from cube_sim.control.probing import put_probe
from cube_sim.control.safe_mode import loses_target
from cube_sim.control.shortage import watch_shortage
from cube_sim.flight.compiled.callees import ANSWERING, ESTIMATING, SHARING, STEERING
from cube_sim.flight.rows import (
    write_actuation,
    write_disturbance,
    write_fins,
    write_joints,
    write_motion,
    write_power,
    write_setpoints,
)
from cube_sim.flight.stop_law import condition_met
from cube_sim.guidance.path_record import path_row
from cube_sim.guidance.speed import speed_at
from cube_sim.guidance.target_record import advanced, see_from_target
from cube_sim.guidance.view_record import VIEW
from cube_sim.mission.divergence import DIVERGED, all_below
from cube_sim.mission.setpoints import command_others
from cube_sim.mission.surface_watch import CLEAR_M, top_of
from cube_sim.native.callee import call_at
from cube_sim.native.compiled import compiled, unlocked
from cube_sim.native.published import publish, published
from cube_sim.tuples import angle_of_turn, put, put_matrix, sextuple, turned_to_world
from cube_sim.vehicle.laws.current import velocity_at
from cube_sim.vehicle.laws.curve_table import commands_of_forces, drawn_power, steady_forces
from cube_sim.vehicle.laws.inflow import commands_in_flow, feel_inflow, whole_forces
from cube_sim.vehicle.laws.propeller_power import feel_flow, put_propellers_power
from cube_sim.vehicle.laws.push import push_wrench
from cube_sim.vehicle.laws.supply_law import charge_left, feed_at, sag
from cube_sim.vehicle.laws.supply_law import count as count_drawn
from cube_sim.vehicle.laws.voltage_law import feed_tables, searched_voltage
from cube_sim.vehicle.plugin.engine import forward, forward_again, step
from cube_sim.vehicle.state import hull_state

BEGIN, FORWARDED, JUDGED, ESTIMATED, UNANSWERED = range(5)
"""How far the tick has come that Python goes on with: not begun; accelerations are up to date; the thrusters are fed
too, and the evidence of faults is in; the state is estimated; and the wrench is asked for that an allocator of the
user's own has no forces for."""
FAILED, TICKED = -1, -2
"""MuJoCo cannot go on; its words are in the engine's text. And: a tick is flown among others, see `Engine.shared`."""
STOPPED = -3
"""A condition of the scenario's `stop` is met at the last tick, and the physics has not gone on from there."""
FLOWN, STOP, MET = range(3)
"""Places in `Notes.told`."""


@compiled
def sense(code, sensing, k, state, known):
    """Estimate the state at one tick.

    Args:
        code: address of that of `estimate`.
        sensing: `Sensing`, moved on; its k-th rows are filled.
        k: which tick it is.
        state: (22,) the true one, of `hull_state`.
        known: (22,) out: the estimate.
    """
    s, R = sensing, state[7:16].reshape(3, 3)
    truth = state[:3], turned_to_world(R, state[16:19]), R, state[19:]
    into = s.answers[k : k + 1], s.errors[k : k + 1], s.arrived[k]
    s.counts[k] = call_at(ESTIMATING, code, (s.parameters, s.memory, *truth, *into))
    put(s.inertial[k], s.memory.imu[0].reading)
    answer = s.answers[k]
    put(known[3:7], answer.quaternion)
    for i in range(3):
        known[i], known[16 + i], known[19 + i] = answer.position[i], answer.velocity[i], answer.rates[i]
        for j in range(3):
            known[7 + 3 * i + j] = answer.rotation[i, j]


@compiled
def _top(e, hull):
    """Height of the highest part of the hull [m]; arguments as in `fly`."""
    return top_of(e.geom_xpos, e.geom_xmat, hull.geoms, hull.radii, hull.centres, hull.halves, hull.surface)


@compiled
def _power(e, feed, given):
    """What the thrusters draw (m,) [W] at forces (m,) [N]; the other arguments as in `fly`."""
    power = drawn_power(feed.packed, feed.efficiency_at, feed.stuck_at, feed.coefficients, given)
    where = feed.packed, feed.efficiency_at, feed.stuck_at, feed.supply_at
    put_propellers_power(feed.driven, e.act, where[0], where[1], where[2], where[3], power)
    return power


@unlocked
def fly(
    codes, first, count, tick, engine, hull, feed, fins, setpoints, joints, evidence, sensing, course, law, planar,
    answering, thrusters, moment, rows, notes, stops,
):  # fmt: skip
    """Fly up to so many ticks.

    Args:
        codes: addresses of code: of `answer` or of `cube_sim.control.planar.steering.steer`, 0 for the other one, and
            of what `answer` calls; `SearchCodes`; that of `estimate`, where the state is estimated; and that of
            `cube_sim.allocation.fin_shares.steer_fins`, where there are fins.
        first: number, among them, of the one to begin with; 0 but for those among others.
        count: how many.
        tick: number of the first of all.
        engine: `Engine`.
        hull: `Hull`.
        feed: `Feed`.
        fins: `FinServos`.
        setpoints: `cube_sim.mission.setpoints.SetpointParts`.
        joints: `cube_sim.vehicle.carried_joints.JointPlaces`.
        evidence: `FaultWatch`.
        sensing: `Sensing`.
        course: `Course`.
        law: `cube_sim.control.answering.LawParts`.
        planar: `cube_sim.control.planar.steering.PlanarParts`.
        answering: `Answering`.
        thrusters: `cube_sim.allocation.responsive.ResponsiveThrusters`.
        moment: `Moment`.
        rows: `cube_sim.flight.rows.TickRows`, so many; filled.
        notes: `Notes`, so many; filled.
        stops: (n,) of `cube_sim.mission.stopping.STOP`, moved on.

    Returns:
        How many were flown, and how far the next one has come.
    """
    e, dt, m = engine, engine.period, len(feed.actuators)
    body, warned, text = e.hull[2], e.warnings.sum(), e.text.ctypes.data
    view, desired, followed = np.zeros(1, VIEW), np.zeros(1, DESIRED), np.zeros(1, FOLLOWED)
    given, activation, force, current = np.empty(m), np.empty(m), np.empty(m), np.zeros(3)
    fins_water = np.zeros(3)
    secondary, parts, sides = np.zeros(6), np.empty(12), np.empty(len(thrusters.which), np.int8)
    disturbance, water, nobody, wrench = np.zeros(6), np.empty(3), np.zeros(m, np.bool_), np.empty(6)
    for k in range(first, count):
        publish(notes.told, FLOWN, k)
        if published(notes.told, STOP):
            return k, BEGIN
        t = (tick + k) * dt
        if not e.shared and not forward(e.model, e.data, text):
            return k, FAILED
        top = max(e.xpos[body, 2], _top(e, hull))
        if (
            e.warnings.sum() != warned
            or not all_below(DIVERGED, e.qpos, e.qvel, e.qacc)
            or top > hull.surface + CLEAR_M
        ):
            return k, FORWARDED
        for i in range(m):
            given[i], activation[i] = e.actuator_force[feed.actuators[i]], e.act[feed.activations[i]]
        now, supply = e.time[0], feed.supply[0]
        state = hull_state(e.qpos, e.qvel, e.xmat, e.xquat, e.hull[0], e.hull[1], body)
        if feed.driven.draws.any():
            put(water, hull.wind)
            if hull.sheared:
                there = velocity_at(now, state[2], hull.times, hull.heights, hull.velocities)
                for i in range(3):
                    water[i] += there[i]
            feel_flow(feed.driven, state, water)
        if supply.battery:
            charge = charge_left(feed.supply, now)
            if charge == 0.0:
                return k, FORWARDED
            supply.charge = charge
            drawn = _power(e, feed, given)
            if feed.searched:
                told = feed.packed, feed.efficiency_at, feed.stuck_at, e.act, drawn
                voltage = searched_voltage(feed.supply, feed.tables, feed.driven, *told)
                feed_at(feed.supply, feed.packed, feed.supply_at, voltage)
                feed_tables(feed.tables, feed.packed, feed.supply_at, voltage)
            else:
                sag(feed.supply, feed.packed, feed.supply_at, drawn)
            # What a propeller turns its hull by beside its force is a passive one, and follows the voltage too.
            if moment.inflow.turns.any():
                went_well = forward(e.model, e.data, text)
            else:
                went_well = forward_again(e.model, e.data, text)
            if not went_well:
                return k, FAILED
            for i in range(m):
                given[i] = e.actuator_force[feed.actuators[i]]
        power = _power(e, feed, given)
        count_drawn(feed.supply, feed.power, power, now)
        put(feed.power, power)
        share, inflow = supply.force_ratio, moment.inflow
        force_ratio = 1.0 if inflow.varies else share
        write_power(rows, k, t, power, supply.energy, supply.voltage, supply.charge)
        if evidence.watched:
            w = evidence.window
            measured = evidence.telemetry_gain * given
            if len(evidence.noise) > 0:
                for i in range(m):
                    measured[i] += evidence.noise[k, i]
            if inflow.varies:
                whole = whole_forces(inflow, share, activation, measured, w.efficiency)
            else:
                whole = steady_forces(feed.curves, feed.starts, activation)
            enter_pair(w, whole, measured, force_ratio)
            if speaks_against(w, force_ratio):
                return k, JUDGED
        R = state[7:16].reshape(3, 3)
        known = state
        if sensing.navigated:
            known = np.empty(22)
            sense(codes[4], sensing, k, state, known)
            R = known[7:16].reshape(3, 3)
        if inflow.varies:
            feel_inflow(inflow, R, known[16:19], known[19:], law.current, share)
            limit_thrusters(thrusters, inflow.limits, moment.margin)
            for i in range(len(fins.parts.forces)):
                if thrusters.responds[i]:
                    fins.parts.forces[i, 0] = thrusters.limits[i, 0] * thrusters.efficiency[i]
                    fins.parts.forces[i, 1] = thrusters.limits[i, 3] * thrusters.efficiency[i]
            limit_budget(moment.budget, inflow.limits)
            put_matrix(notes.limits[k], inflow.limits)
        velocity_W = turned_to_world(R, known[16:19])
        s = course.arc_length[0]
        planned, slope, place = 0.0, 0.0, s
        if course.target[0].clocked:
            planned, slope = speed_at(*course.plan, s)
            place = min(s, course.target[0].last)
        row = path_row(*course.path, place)
        see_from_target(view, course.target, row, planned, s, known[:3], velocity_W)
        loss = course.loss.copy()
        if loses_target(loss, view[0].error, dt):
            return k, ESTIMATED
        course.loss[0].was_near, course.loss[0].since = loss[0].was_near, loss[0].since
        course.loss[0].nearest, course.loss[0].distance = loss[0].nearest, loss[0].distance
        desired[0].quaternion[:] = 0.0
        desired[0].rates[:] = 0.0
        taken = law.refuge[0].taken
        records, speed, rates = (view, desired, followed), known[16:19], known[19:]
        if answering.in_plane:
            call_at(STEERING, codes[1], (planar, *records, R, speed, rates, answering.applied, dt))
            put(disturbance, planar.estimated[0].disturbance)
            put(current, planar.estimated[0].current)
        else:
            motion = R, known[3:7], speed, rates
            call_at(ANSWERING, codes[0], (law, *records, *motion, answering.applied, dt, force_ratio, codes[2]))
            if law.settings[0].disturbance_time > 0.0:
                put(disturbance, law.disturbance[0].estimate)
            if law.settings[0].current_time > 0.0:
                put(current, law.current)
        out, wanted = followed[0], desired[0].quaternion
        if not isfinite((out.wrench**2).sum() + (wanted**2).sum() + (view[0].error ** 2).sum()):
            return k, ESTIMATED
        if law.own.in_parts:
            put(secondary, law.own.secondary)
        elif answering.yields:
            yield_attitude(answering.coupling, out.wrench, secondary)
        missed = 0.0
        put(fins.rest, out.wrench)
        if fins.steered:
            for i in range(len(fins.actuators)):
                fins.deflections[i] = e.act[fins.activations[i]]
            put(fins_water, current)
            if law.course[0].steered:
                put(fins_water, law.course[0].water)
            motion_seen = R, speed, rates, fins_water
            shared = fins.wanted, fins.made, fins.rest
            put(wrench, out.wrench)
            missed = call_at(
                SHARING, codes[5], (fins.parts, wrench, *motion_seen, fins.deflections, force_ratio, *shared)
            )
        before = sextuple(answering.applied)
        asked, residual, cost, status = allocate_responsive(
            codes[3], thrusters, fins.rest, secondary, force_ratio, parts,
            notes.demands[k], notes.answers[k % len(notes.answers)], sides, answering.applied, notes.effort,
        )  # fmt: skip
        if isnan(residual):
            put(answering.applied, before)
            return k, UNANSWERED
        if fins.steered:
            residual, status = with_missed(residual, status, missed)
            for i in range(6):
                answering.applied[i] += fins.made[i]
            for i in range(len(fins.actuators)):
                e.ctrl[fins.actuators[i]] = fins.wanted[i]
            write_fins(rows, k, t, fins.wanted, fins.deflections, fins.made)
        if evidence.watched:
            w = evidence.window
            put_probe(evidence.probes, w.efficiency, w.stuck, nobody, asked)
        if inflow.varies:
            commands = commands_in_flow(inflow, share, asked)
        else:
            commands = commands_of_forces(feed.curves, feed.starts, asked)
        for i in range(m):
            e.ctrl[feed.actuators[i]], force[i] = commands[i], thrusters.force[i] * force_ratio
        if len(setpoints.actuators) > 0:
            command_others(setpoints, t, e.ctrl)
            write_setpoints(rows, k, t, setpoints, e.act)
        if len(joints.positions) > 0:
            write_joints(rows, k, t, joints, e.qpos, e.qvel)
        notes.pace[k], notes.force_ratio[k] = out.pace, force_ratio
        put(water, hull.wind)
        if hull.sheared:
            there = velocity_at(t, state[2], hull.times, hull.heights, hull.velocities)
            for i in range(3):
                water[i] += there[i]
        off = angle_of_turn(wanted, state[3:7]) if sensing.navigated else out.attitude_error
        write_motion(rows, k, t, state, view, followed, wanted, off, disturbance, current, water)
        if hull.pushed:
            write_disturbance(rows, k, t, push_wrench(hull.pushes, hull.number, state[7:16].reshape(3, 3), t, 0.0))
        write_actuation(
            rows, k, t, answering.applied, force, commands, given, thrusters.subset, residual, cost, status,
            feed.efficiency, thrusters.efficiency, answering.authority,
        )  # fmt: skip
        put(answering.quaternion, wanted)
        put(answering.state, known)
        course.arc_length[0] = advanced(course.target, slope, s, view[0].speed, dt)
        pressed = course.shortage[0].pressed
        if law.settings[0].budgeted:
            watch_shortage(course.shortage, out.enough, law.settings[0].balanced, law.balanced, dt)
        if len(stops) > 0:
            met = condition_met(stops, rows, k, t)
            if met >= 0:
                notes.told[MET] = met
                return k + 1, STOPPED
        if not e.shared and not step(e.model, e.data, text, e.steps, e.classical):
            return k + 1, FAILED
        if law.refuge[0].taken != taken or (course.shortage[0].pressed != pressed and not course.steers):
            return k + 1, BEGIN
        if law.settings[0].balanced and law.balanced[0].stale:
            return k + 1, BEGIN
        if e.shared:
            return k + 1, TICKED
    return count, BEGIN
