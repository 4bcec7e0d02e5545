"""docs/recording.md: every channel and field a run can record, from the channel tables; how the files are laid out."""

from __future__ import annotations

from collections.abc import Iterator
from datetime import UTC, datetime
from typing import get_args

from cube_sim.allocation import Status
from cube_sim.commands.pages.markdown import block, code, heading, link, table
from cube_sim.control.authority import Authority
from cube_sim.mission.channels import PATH_POINTS
from cube_sim.recording.channels import ON_CHANGE, TICK_HZ, Channel, Field, channel_table
from cube_sim.recording.header import SOURCE
from cube_sim.recording.mcap.names import (
    CHANNEL_METADATA,
    CODE,
    CODE_DIGESTS,
    CODE_METADATA,
    END_METADATA,
    EPOCH_NS,
    FORMAT,
    LOG_TOPIC,
    RESOLVED,
    RUN_METADATA,
    SCENARIO,
    TRANSFORM_TOPIC,
    VEHICLES_METADATA,
    VERSIONS_METADATA,
    topic,
)
from cube_sim.recording.mcap.schemas import FRAME_TRANSFORM, LOG, LOG_LEVELS, channel_schema_name
from cube_sim.recording.navigation_channels import READINGS, navigation_channels
from cube_sim.recording.run_end import How
from cube_sim.run_log import ALIKE, LogLine
from cube_sim.verdict import CheckResult, Flown, to_json

_SEVERAL = f"""\
A run of several vehicles is one record. A channel of a vehicle stands under its name, `leader/pose`, and so does a
signal, `leader/pose.position`; each has the table below, whatever others there are. The channel `distance` has a field
for every two vehicles, `leader_to_follower`: the distance between their body origins [m], at each control period. A
sentence of the log that is about one vehicle begins with its name, `leader: T1: dead`. The metadata
`{VEHICLES_METADATA}` names the hull of each vehicle in its own model; the files of each are called
`vehicles/NAME/KEY/FILE`. What viewers draw of a vehicle is below its name too, `/leader/scene` and
`/leader{TRANSFORM_TOPIC}`; its frame is called after it.

`load_run(...).vehicles` has the run of each vehicle under the names it would have alone: its scenario, signals, log and
checks. `whole` is the scenario of all of them, and `together` the run as the checks over several see it."""

WRITTEN_BY = {
    "actuation": "the allocator: the thrusters as the controller believes them, at the start, and again when it "
    "believes something else or the supply's voltage changes",
    "path": "guidance, once, at time 0",
    "pose": "MuJoCo, at the start of the control period",
    "velocity": "MuJoCo, at the start of the control period",
    "target": "guidance",
    "path_error": "guidance; of the true state, also where the controller flies on an estimate",
    "reference": "guidance and the attitude mode: what control is asked for",
    "wrench": "control, its disturbance observer and the allocator",
    "allocation": "the allocator",
    "thrusters": "the allocator, the inverse of the thrusters' characteristic, and MuJoCo",
    "power": "the power supply",
    "health": "the scenario's events (the truth), the fault diagnosis and control (the belief)",
    "water": "the water (the truth) and the current observer (the estimate)",
    "disturbance": "the scenario's events of kind `force`",
    "fins": "the allocation, and MuJoCo",
    "fin_health": "the scenario's events of kind `fins`, and what the controller is told of them; where it has any",
    "setpoints": "the scenario's `setpoints` and events of kind `setpoint`, and MuJoCo; where it has any",
    "joints": "MuJoCo, at the start of the control period; where the hull carries anything on a joint",
    "phase": "the scenario's phases, at the tick at which one begins",
    "navigation": "the estimator",
    "navigation_error": "the estimator against MuJoCo",
    "sensor_imu": "the inertial unit",
    **{f"sensor_{name}": f"the {told.instrument}, when a reading arrives" for name, told in READINGS.items()},
}
"""Which part of the program a channel's numbers come from."""

_CHECK = CheckResult("rms of path_error.cross_track", "PASS", 0.031, "<=", 0.1, 0.069, 52.36, "4001 samples", "m")
_FLOWN = Flown(120.0, None, (LogLine(40.0, "WARNING", "T1: dead"),))
_EPOCH = f"{datetime.fromtimestamp(EPOCH_NS // 10**9, UTC):%Y-%m-%dT%H:%M:%SZ}"
_FEW = 6
_INTRODUCTION = f"""\
<!-- Made by `cube-sim reference recording > docs/recording.md` from the channel tables in cube_sim/recording/. -->

# Recordings: files, channels, fields

A run writes four files into its folder.

| file | what it holds |
| --- | --- |
| `run.mcap` | the record: inputs, versions, every signal, what was said, how it ended; the same bytes on one machine |
| `run.rrd` | the same for the Rerun viewer: a function of `run.mcap`, from which `cube-sim view` makes it anew |
| `{RESOLVED}` | the scenario with every default written out; run as it is, it gives the same signals |
| `verdict.json` | the verdict, of each check value, limit, margin, unit, time and reason, and the log's warnings |

They are opened when the first simulated second is flown, or the end of a shorter flight. Until then an earlier run in
the folder stays whole, whatever becomes of this one: bad input, an error, Ctrl-C, a kill, a disk without room. The new
record takes its place in one move, with its first second in it. The room of `verdict.json` is taken then too: a disk
that fills later is told there. A `recover` replaces an earlier run once the new record is whole.

A signal is called `channel.field`, as in `path_error.cross_track`: by that name a check asks for it, and by that name
it is read back. `cube-sim signals SCENARIO` lists those of one scenario, with the names of its thrusters and sensors.

Of these `run.mcap` alone is held against another by its bytes. `resolved.yaml` names files as they are seen from its
folder, and `verdict.json` has how fast that flight was, `real_time_factor`; all else in the two is the same again.
Two `run.rrd` of one record show the same, to the bit, and have the same recording id, but not the same bytes: Rerun
gives each piece of a file an id of the wall clock and a random number, which its interface does not let anybody choose.
`rerun rrd compare --unordered` holds two of them against each other; a gap of a curve, as where a heading passes 180
degrees, is no number, and that is a difference to it even where both have it.
"""
_READING = """\
from cube_sim.recording.reading import read_recording, read_signals

signals = read_signals("logs/first/run.mcap")  # "channel.field" -> (n, 1 + columns), the bits the run had in memory
t, error = signals["path_error.cross_track"].T  # column 0 is the simulated time [s]

recording = read_recording("logs/first/run.mcap")  # the same, and the inputs: .header.scenario, .header.mjcf, .log ...
"""
_AS_A_RUN = """\
import cube_sim

run = cube_sim.load_run("logs/first")  # a folder, or its run.mcap
run.signals["pose.position"], run.fields["pose.position"].unit
run.verdict, run.checks, run.how, run.ended_early, run.simulated_s, run.versions, run.build, run.flaw, run.losses
run.to_pandas("allocation")  # or to_polars
"""
_TABLES = """\
A frame, and a table of `cube-sim export`, has a column for each number: its name and, in brackets, its unit. A code has
two: `status [1]` is the number, `status [name]` its word, a categorical in pandas, an Enum in polars, a dictionary in
Parquet. A number that stands for nothing has no word. `run.fields["allocation.status"].labels` has all there are.
A run equals itself alone; `cube-sim diff` compares two. Below a run is what the file holds, and nothing else:"""
_POSE, _PATH_ERROR = Channel("pose", ()), Channel("path_error", ())
_LAYOUT = f"""\
An [MCAP](https://mcap.dev/spec) file, readable by any MCAP and protobuf reader.

- **Attachments**: `{SCENARIO}` as it was written; `{RESOLVED}`; every file that this names, under the name it uses:
  `model/cube.xml`, `path.file/survey.csv`, by key; what an MJCF includes, attaches or takes meshes from, beside it.
  Python of the user's own is there as `{CODE}KEY/FILE`, the key being the scenario's value in whose place it stands;
  modules that go by dotted names are there once more, with those they import, as `{CODE}modules/PACKAGE/MODULE.py`.
  Saved into a folder as they are called, they can be run again; no name depends on the machine.
  `cube-sim replay` runs that Python: replay a record of somebody else's only if you would run their code.
- **Metadata**: `{RUN_METADATA}` has the format ({FORMAT}), the seed and the vehicle's name, `{VERSIONS_METADATA}` the
  version of each package that takes part in the numbers, and what else does: `{SOURCE}`, the SHA-256 of the program's
  own source, its commit where it ran from a checkout, the processor, OpenBLAS's kernel, the C library.
  Where Python of the user's own flew, `{CODE_METADATA}` has its
  names by key, `{CODE_DIGESTS}` the SHA-256 of their files.
- **A topic per channel**: `{topic(_POSE)}` for the channel `{_POSE.name}`. A row is one protobuf message, called
  `{channel_schema_name(_PATH_ERROR)}` for the channel `{_PATH_ERROR.name}`. Its field 1 is `t`, the simulated time [s].
  The channel's fields follow as 2, 3 ... in the order of the tables below, and every number has its name and unit, as
  in `/path_error.cross_track_m`, `/pose.position.x_m`, `/thrusters.force_demanded.T1_N`, `/wrench.demanded.Mz_N_m`: a
  double, or a message of doubles named after the columns (`Fx/T1` is a message `Fx` with a `T1` in it, `0/x` one of a
  list). A code is an enum: `/allocation.status` reads `EXACT`. The descriptors are in the file. The channel's metadata
  `{CHANNEL_METADATA}` is its table as JSON: names, widths, units, descriptions with frames, columns, labels.
- **For other programs' viewers**: `{TRANSFORM_TOPIC}` is the pose once more, as `{FRAME_TRANSFORM}`. `{LOG_TOPIC}` is
  what was said, as `{LOG}` with the levels {", ".join(LOG_LEVELS[1:])}. What there is to see comes as
  `foxglove.SceneUpdate`: `/scene` the hull, `/scene/path` the path, each one message; `/scene/thrust` the forces of the
  thrusters, ten times a second; `/scene/trail` where the vehicle was, every five seconds. `/tf/target` is the frame of
  the virtual target. They are 2.3 % of the file, rounded, and no signals: nothing is read back of them.
  `cube-sim export --format layout` writes a layout that shows them in Foxglove and Lichtblick.
- **Times**: simulated time starts at {_EPOCH} in every file. There is no wall clock in it.
- **Chunks**: one simulated second each, compressed with zstd and handed to the operating system when it is over. A
  killed process loses less than a second. What is whole is read, and the recording is marked incomplete. Messages stand
  in the order of time, those of one instant in the order of the tables. A message's sequence number counts the rows of
  its channel from 0.
- **The end**: behind the last chunk, the metadata `{END_METADATA}` says how the run ended. Its values are JSON. `how`
  is one of {", ".join(f"`{how}`" for how in get_args(How))}; `reason` says why, `ticks` and `simulated_s`
  what was really flown, `given_up` why the path was given up at the end. `verdict` and `checks` are those of
  `verdict.json`. `digests` has the SHA-256 of each file and table before the rows, of the log, and of each channel: of
  the text of its metadata `{CHANNEL_METADATA}`, then of its rows in the order of their sequence numbers, each number as
  the eight bytes of a double, least significant first, the time first. `sha256` is that of all these texts as one
  JSON object, keys sorted. It is metadata, for programs that sort, merge or compress a file anew carry that along,
  and none of them makes such digests.

`load_run(...).complete` says that the end is there, that the flight came to it (`completed` or `ended early`), and that
all digests fit what was read; `flaw` says what does not. A file that others have sorted, compressed anew or written
without chunks is read the same. Two runs merged into one file are refused, and so is a chunk that does not fit its
checksum: `cube-sim recover` writes the others into a new record, which is never complete. Records of formats before
{FORMAT} are read as well; they do not say how their run ended, nobody can tell whether their numbers were altered, and
they never count as complete.

`recover` names each channel that lacks rows, from when to when, and how many: `load_run(...).losses` has the same.
Where a recovered record has no rows, nothing is drawn: curves are broken, pages hatch that time and name it at the top.

`cube-sim judge` judges a record that is not complete by the rows that are there. A check is FAIL where they show that
it fails, whatever is missing: a maximum beyond its limit stays beyond it. What missing rows of its window might change
is an ERROR: a maximum within its limit, an RMS, a value at the end. The whole is FAIL or ERROR, never PASS. So a run
that was interrupted, ERROR in its own `verdict.json`, may be shown to FAIL. A record that was altered shows nothing.

It reads a record once, some seconds at a time, in the same memory however long it is: also one that is cut off,
recovered or compressed anew. Not so a record whose messages another program has put out of the order of time or outside
chunks, whose sequence numbers it has lost, or that is refused as damaged: that is read as a whole, with the same
results, in memory that grows with its length. All other commands, and `load_run`, read any record as a whole."""
_VERDICT = f"""\
`verdict` is PASS when every check was shown to hold, FAIL when one was shown not to, ERROR when none failed but
something could not be judged. `value` is the worst value and `at_s` when it was. `margin` is its distance from the
limit, positive on the side that passes. `unit` is that of all three, "1" for a pure number. What could not be judged is
null. Verdict and checks stand at the end of the record too, and in the view: `load_run(...).verdict` and `.checks` are
those of `cube_sim.run(...)`.

`simulated_s` is the time really flown. `ended_early` is null, or has `time_s`, `reason` and `verdict` of a run that
ended before its time. With the verdict ERROR its state left all bounds, the controller had no answer, somebody stopped
it, or its files could not be written: that is the run's verdict too. With PASS or FAIL a condition of the scenario's
`stop` was met: a proper end, whose checks judge what was flown, or a failure.

`log` holds what was said at the levels WARNING, ERROR and FATAL: faults, a path given up, a vehicle that stays off its
path, a wrench out of reach, a hull that comes out of the water, MuJoCo's warnings. What was said again is one entry:
how often (`count`), first and last (`time_s`, `last_s`). Of sentences that differ in nothing but their numbers {ALIKE}
are told; the rest count as the last of these. The terminal, a failing pytest item and the properties of its JUnit case
show the same.
`cube_sim.run(...).log` has each sentence, the log in `run.mcap` also those of level INFO."""
_CHANNELS = f"""\
*m* is the number of thrusters, in the order of the columns of A. World axes are ENU, body axes FLU, units SI. The unit
1 is a pure number. Quaternions are w, x, y, z. "Every period" is a row for each control period, {TICK_HZ:g} Hz unless
the scenario sets `control_period_s`. A row "on change" holds until the next; no check can be made of it. What is not
modelled is not recorded: `power` has the quantities that the model and the scenario state, `charge` with a `battery`
alone. `power.voltage` is that of the bus: of a `battery` as it sags; without one the constant voltage for which the
model states what its thrusters do (`NAME:thruster_voltage`), at which they are simulated."""


def recording_page() -> str:
    """The page as Markdown text, ending in a newline."""
    usual, navigation = _tables(1), navigation_channels(dict.fromkeys(READINGS, 0.0))
    wider = {channel.name: channel for channel in _tables(2)}
    parts = [
        _INTRODUCTION.rstrip(),
        heading(2, "Read it in Python"),
        block(_AS_A_RUN, "python"),
        _TABLES,
        block(_READING, "python"),
        heading(2, "How `run.mcap` is laid out"),
        _LAYOUT,
        heading(2, "`verdict.json`"),
        _VERDICT,
        block(to_json("PASS", [_CHECK], 20.5, {"cube-sim": "0.1.0", "mujoco": "4.0.0"}, _FLOWN), "json"),
        heading(2, "Channels"),
        _CHANNELS,
        table(("channel", "a row", "written by"), [_line(channel) for channel in (*usual, *navigation)]),
        heading(2, "Several vehicles"),
        _SEVERAL,
        heading(2, "Channels of every run"),
        *(part for channel in usual for part in _section(channel, wider[channel.name])),
        heading(2, "Channels of a run with `navigation`"),
        "The controller then flies on an estimate. A sensor that the scenario leaves out has no channel.",
        *(part for channel in navigation for part in _section(channel, channel)),
    ]
    return "\n\n".join(parts) + "\n"


def _tables(m: int) -> tuple[Channel, ...]:
    """The channels of a vehicle with m thrusters, T1 to Tm, and as many fins."""
    names = tuple(f"T{i + 1}" for i in range(m - 1))
    joints = (*(f"J{i + 1}" for i in range(m - 1)), "Jk")
    return channel_table(
        (*names, "Tm"),
        PATH_POINTS,
        tuple(status.name for status in Status),
        tuple(authority.name for authority in Authority),
        pushed=True,
        phases=("the names of the phases",),
        timed=True,
        fins=(*(f"F{i + 1}" for i in range(m - 1)), "Fk"),
        setpoints=(*(f"A{i + 1}" for i in range(m - 1)), "Ak"),
        setpoint_units=(("of the actuator", "of the actuator"),) * m,
        failing=(*(f"F{i + 1}" for i in range(m - 1)), "Fk"),
        joint_positions=tuple((name, "rad or m") for name in joints),
        joint_velocities=tuple((name, "rad/s or m/s") for name in joints),
    )


def _line(channel: Channel) -> tuple[str, str, str]:
    return link(code(channel.name), code(channel.name)), _rate(channel), WRITTEN_BY[channel.name]


def _rate(channel: Channel) -> str:
    if channel.name.removeprefix("sensor_") in READINGS:
        return "per reading"
    return "on change" if channel.rate == ON_CHANGE else "every period"


def _section(channel: Channel, wider: Channel) -> Iterator[str]:
    """A channel's table.

    Args:
        channel: of a vehicle with one thruster.
        wider: the same of a vehicle with two: what has grown is per thruster.
    """
    yield heading(3, code(channel.name))
    many = "k" if channel.name in ("fins", "fin_health", "setpoints", "joints") else "m"
    rows = [_row(one, two, many) for one, two in zip(channel.fields, wider.fields, strict=True)]
    yield table(("field", "columns", "unit", "what it is"), rows)


def _row(field: Field, wider: Field, many: str) -> tuple[str, str, str, str]:
    per_thruster = wider.width - field.width
    count = str(field.width)
    if per_thruster:
        count = many if per_thruster == 1 else f"{per_thruster} {many}"
    named = _elided(wider.columns if per_thruster else field.columns)
    meaning = field.doc
    if field.labels:
        meaning += ": " + ", ".join(f"{value} {code(label)}" for value, label in enumerate(field.labels))
    return code(field.name), f"{count}: {named}" if named else count, field.unit, meaning


def _elided(columns: tuple[str, ...]) -> str:
    if len(columns) <= _FEW and not {"Tm", "Fk", "Ak", "Jk"} & set(columns):
        return ", ".join(columns)
    return f"{columns[0]} ... {columns[-1]}"
