"""The section of docs/scenario.md on several vehicles."""

TITLE = "Several vehicles"
TEXT = """\
`vehicles` is a block of names (small letters, digits, `_`), each with the keys of one vehicle. They swim in the same
water and can touch. What stands at the top is what every vehicle has that does not say otherwise: blocks are merged key
by key, a list is replaced as a whole, and so is a block that names another `type`, `mode` or `kind`. So each vehicle is
an ordinary scenario, and every rule of this page holds for it.

| at the top, for all | in a vehicle's block, or at the top as its default | in a vehicle's block alone |
|---|---|---|
| `schema_version`, `name`, `description`, `duration_s`, `physics`, `control_period_s`, `current_m_s`, \
`current_profile`, `surface_m`; `events` of the water; `checks` over several vehicles; `samples` | \
`model`, `vehicle`, `initial`, `thrusters`, \
`parameters`, `battery`, `path`, `guidance`, `control`, `navigation`, `knowledge`, `telemetry`, `allocation`, \
`setpoints`, `stop` | \
`events` of its thrusters and set-points, `checks` of its own, `seed` |

Vehicles of one model each get a copy of it; a model with several hulls is shared by vehicles that name different ones
(`vehicle`). The random streams of a vehicle come of the seed at the top and of its name, not of its place in the list;
with `seed` in its block they are those of that seed alone. A vehicle that touches no other flies as it flies alone, to
the bit. What ends the flight of one, or a condition of its `stop`, ends that of all, and is said with its name.
`samples` stand at the top, too, and vary keys of the world or of a vehicle, `vehicles.leader.guidance.speed_m_s`,
`vehicles.follower.parameters.hull:mass`; thrusters that are lost are events of a vehicle."""
EXAMPLE = """\
model: ../models/cube.xml
guidance: {speed_m_s: 0.3}
vehicles:
  leader:
    path: {type: line, start_m: [0, 0, -5], end_m: [6, 0, -5]}
    initial: {position_m: [0, 0.2, -5]}
    checks:
      - {kind: signal, signal: path_error.cross_track, statistic: final, at_most: 0.02}
  follower:
    path: {type: line, start_m: [-2, 0, -5], end_m: [4, 0, -5]}
    initial: {position_m: [-2, 0, -5]}
checks:
  - {kind: distance, between: [leader, follower], statistic: min, at_least: 1.0}
  - {kind: signal, signal: follower/path_error.cross_track, statistic: max, at_most: 0.05}"""
CHECKS = """\
All of them are recorded in one record: a channel of a vehicle stands under its name, and so does a signal that a check
at the top names, `follower/path_error.cross_track`. The distance between the body origins of two vehicles is recorded
as `distance.leader_to_follower` [m]. A check at the top is of the kind `signal`, `always`, `eventually`, `ratio` or
`before_after`, of signals of one vehicle or of several, its events those at the top; or of the kind `distance`: it
takes `between`, the names of two vehicles, `at_most` or `at_least` [m], and all else that one of the kind `signal`
takes but `signal`, `minus`, `component` and `combine`. The log says which vehicle each
sentence is about, and when two begin to touch.

`--set vehicles.leader.guidance.speed_m_s=0.2` changes a value of one vehicle, `--set guidance.speed_m_s=0.2` the one
that all have by default."""
