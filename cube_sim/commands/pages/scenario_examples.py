"""Examples of scenario files, by the key they show; the tests load each of them."""

from __future__ import annotations

WHOLE = """\
schema_version: 1
name: short_line
model: ../models/cube.xml
duration_s: 20
path: {type: line, start_m: [0, 0, -5], end_m: [4, 0, -5]}
initial: {position_m: [0, 1, -5]}
guidance: {speed_m_s: 0.4}
checks:
  - {kind: path_end, reach_m: 0.5}
"""
"""A whole scenario; what `BLOCKS` holds takes the place of its keys."""

BLOCKS = {
    "physics": """\
physics: {integrator: implicitfast, step_s: 0.005}
""",
    "initial": """\
initial:
  position_m: [7.0, -3.0, -8.0]
  attitude_deg: [0.0, 0.0, -120.0]
""",
    "current_profile": """\
current_profile:
  depths_m: [0, 4, 10]
  velocities_m_s: [[0.3, 0, 0], [0.2, 0.05, 0], [0, 0, 0]]   # strongest at the surface
""",
    "thrusters": """\
thrusters: {dead_zone_N: [-2.0, 2.0]}
""",
    "battery": """\
battery: {open_circuit_V: [12.8, 16.8], resistance_ohm: 0.06, capacity_Wh: 266, charge: 0.3}
""",
    "path:line": """\
path: {type: line, start_m: [0, 0, -5], end_m: [20, 0, -5]}
""",
    "path:point": """\
path: {type: point, position_m: [2, 0, -5], heading_deg: 90}
""",
    "path:arc": """\
path: {type: arc, start_m: [0, 0, -5], through_m: [5, 5, -4], end_m: [10, 0, -5]}
""",
    "path:circle": """\
path: {type: circle, centre_m: [0, 0, -5], radius_m: 6, direction: right, laps: 2}
""",
    "path:helix": """\
path: {type: helix, centre_m: [0, 0, -8], radius_m: 3, pitch_m: 3, turns: 2}
""",
    "path:sinusoid": """\
path: {type: sinusoid, start_m: [0, 0, -5], amplitude_m: 3, wavelength_m: 20, periods: 2.5}
""",
    "path:polyline": """\
path:
  type: polyline
  points_m: [[0, 0, -5], [10, 0, -5], [10, 8, -7], [0, 8, -7]]
  corner_radius_m: 1.5
""",
    "path:spline": """\
path:
  type: spline
  points_m: [[0, 0, -5], [6, 2, -5], [8, 8, -6], [0, 8, -6]]
  closed: true
  laps: 1
""",
    "path:csv": """\
path: {type: csv, file: survey.csv, shape: polyline, corner_radius_m: 1.0}
""",
    "waypoints": """\
waypoints:
  - {to_m: [4, 0, -5]}
  - {to_m: [4, 3, -5], speed_m_s: 0.2, hold_s: 5, heading_deg: 90}
  - {to_m: [0, 3, -5]}
""",
    "phases": """\
phases:
  - {name: there, path: {type: line, start_m: [0, 0, -5], end_m: [4, 0, -5]}, time_limit_s: 30, when_late: fail}
  - {name: look around, path: {type: point, position_m: [4, 0, -5], heading_deg: 180}, within_deg: 5, hold_s: 2}
  - {name: rest, path: {type: point, position_m: [4, 0, -5], heading_deg: 180}, for_s: 5}
  - {name: down, path: {type: line, start_m: [4, 0, -5], end_m: [4, 0, -7]}, guidance: {speed_m_s: 0.2},
     attitude: {mode: fixed, attitude_deg: [0, 0, 180]}}
""",
    "guidance": """\
guidance:
  speed_m_s: 0.4
  lateral_acceleration_m_s2: 0.05   # slower where the path bends
  stop_at_end: false
""",
    "control": """\
control:
  velocity_time_s: 0.8
  faults: told
  cost_limit: 10
""",
    "control.safe_mode": """\
control:
  safe_mode: {action: surface, surface_m: -0.5, drop_weight_N: 20}
""",
    "control.attitude": """\
control:
  attitude: {mode: look_at, point_m: [0, 0, -6]}
""",
    "navigation": """\
navigation:
  dvl: {rate_hz: 4, noise_m_s: 0.02}
  heading: null              # no compass
  position: {rate_hz: 0.2}   # an acoustic fix every 5 s
""",
    "knowledge": """\
knowledge: {mass: 1.1, drag: 0.7}   # the controller believes this of a vehicle that has not changed
""",
    "telemetry": """\
telemetry:
  noise_N: 1.0
  thruster_gains: [1.05, 0.95, 1.1, 1, 1, 1, 0.9, 1]   # within 1 +- gain_tolerance
""",
    "allocation": """\
allocation:
  objective: reactivity
  reversal_penalty_N2: 256
  unattainable: scaled
""",
    "events": """\
events:
  - {kind: thrusters, at_s: 5, thrusters: [T1, T4], state: dead}
  - {kind: thrusters, at_s: 8, thrusters: [T2], state: weak, efficiency: 0.5}
  - {kind: current, at_s: 12, current_m_s: [0, 0.2, 0]}
  - {kind: current, name: the tide turns, at_s: 14, current_m_s: [0, -0.2, 0], over_s: 5}
  - {kind: force, name: the tether snags, at_s: 16, for_s: 2, over_s: 0.5, force_N: [-20, 0, 5], point_m: [-0.25, 0, 0]}
""",
    "stop": """\
stop:
  - {kind: path_end, reach_m: 0.3, for_s: 2}
  - {kind: given_up}
  - {kind: signal, name: at the surface, signal: pose.position, component: 2, above: -0.3, for_s: 1, verdict: fail}
""",
    "checks": """\
checks:
  - kind: signal
    name: cross-track RMS after convergence
    signal: path_error.cross_track
    statistic: rms
    from_s: 10
    at_most: 0.10
  - {kind: signal, signal: pose.position, component: 2, statistic: max, at_most: -4}
  - {kind: path_end, reach_m: 0.5}
  - {kind: allowed_forces}
  - {kind: exact_wrench, at_most: 1.0e-3}
""",
    "samples": """\
samples:                     # cube-sim sweep flies all 200, cube-sim run --sample 17 one
  count: 200
  required: {pass_rate: 0.95, confidence: 0.95}
  vary:
    guidance.speed_m_s: {distribution: uniform, low: 0.3, high: 0.5}
    parameters.hull:mass: {distribution: uniform, gives: percent, low: -5, high: 5}
    parameters.hull:added_mass: {distribution: normal, gives: factor, mean: 1, std: 0.1, at_least: 0.5}
    current_m_s: {distribution: direction, high: 0.2}
  lost_thrusters: {losses: [0, 1], choose: random, at_s: 5, until_s: 15}
""",
    "samples.vary": """\
samples:
  count: 64
  vary:
    initial.position_m: {distribution: uniform, gives: offset, low: [-1, -1, 0], high: [1, 1, 0]}
    initial.attitude_deg.2: {distribution: normal, mean: 0, std: 20, at_least: -90, at_most: 90}
    control.faults: {distribution: choice, values: [diagnosed, ignored], weights: [3, 1]}
    knowledge.drag: {distribution: log_normal, median: 1.0, log_std: 0.2}
""",
    "samples.vary:grid": """\
samples:                     # 3 x 5 samples
  vary:
    allocation.objective: {distribution: grid, values: [energy, reactivity, reactivity_by_side]}
    guidance.speed_m_s: {distribution: grid, low: 0.2, high: 0.6, points: 5}
""",
    "samples.vary:sobol": """\
samples:
  count: 256
  vary:
    knowledge.mass: {distribution: sobol, low: 0.8, high: 1.2}
    knowledge.drag: {distribution: sobol, low: 0.5, high: 2.0}
""",
    "samples.lost_thrusters": """\
samples:                     # all 36 losses of one or two of eight
  lost_thrusters: {losses: [1, 2], at_s: 5}
""",
    "checks:signal": """\
checks:
  - {kind: signal, signal: path_error.cross_track, statistic: percentile, percent: 95, at_most: 0.3, from_s: 10}
  - {kind: signal, signal: path_error.cross_track, statistic: settling, band: [0, 0.1], at_most: 15}
  - {kind: signal, signal: power.motor, combine: sum, statistic: integral, at_most: 5000}   # J
""",
    "checks:always": """\
checks:
  - {kind: always, all: [{signal: pose.position, component: 2, at_most: -1}]}
  - kind: always
    name: slow near the bottom
    any:
      - {signal: pose.position, component: 2, at_least: -9, scale: 1}
      - {signal: velocity.linear, at_most: 0.2, scale: 0.1}
""",
    "checks:eventually": """\
checks:
  - kind: eventually
    name: at rest at the end of the path
    from_s: 5
    all:
      - {signal: target.remaining, at_most: 0.1, scale: 0.1}
      - {signal: velocity.linear, at_most: 0.05, scale: 0.05}
""",
    "checks:ratio": """\
checks:
  - kind: ratio
    name: energy per metre
    numerator: {signal: power.energy, statistic: increase, from_s: 5, to_s: 15}
    denominator: {signal: target.arc_length, statistic: increase, from_s: 5, to_s: 15}
    at_most: 400
""",
    "checks:before_after": """\
events:
  - {kind: thrusters, at_s: 10, thrusters: [T1], state: dead}
checks:
  - kind: before_after
    name: cross-track RMS after the loss
    event: 0
    signal: path_error.cross_track
    statistic: rms
    before_s: 4
    after_s: 5
    delay_s: 2
    at_most: 0.1
""",
}
