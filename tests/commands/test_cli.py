"""The command line as scripts and people meet it: exit codes, streams, and one line per mistake."""

from __future__ import annotations

import contextlib
import json
import os
import pty
import re
import resource
import shlex
import shutil
import signal
import subprocess
import sys
import time
from importlib.metadata import version
from pathlib import Path

import pytest
from mcap.reader import make_reader
from support.command_line import call, cube_sim, interruptible, started, without_compiling
from support.scenario_files import FLIGHT, MINIMAL, write

from cube_sim import fly, load_run, simulation
from cube_sim.flight.compiled import compile_beside
from cube_sim.run_directory import FILES
from cube_sim.scenario import load
from cube_sim.scenario.json_schema import json_schema

HEAVY = ("mujoco", "rerun", "numba", "scipy", "pydantic", "numpy", "rich", "ruamel", "proxsuite")


@pytest.fixture(scope="module", autouse=True)
def machine_code(tmp_path_factory):
    """Make it before anything is said of it, or before files may not grow to hold it."""
    if compile_beside():
        folder = tmp_path_factory.mktemp("first")
        fly(write(folder, FLIGHT), out=folder / "out")


# Without flying


def test_script_and_module_are_the_same(tmp_path):
    script = shutil.which("cube-sim", path=os.path.dirname(sys.executable))
    assert script, "the package is not installed"
    for arguments in (["--help"], ["run", "none.yaml"], ["fly"]):
        module = cube_sim(*arguments, cwd=tmp_path)
        direct = subprocess.run([script, *arguments], cwd=tmp_path, capture_output=True, text=True, timeout=60)
        assert (direct.returncode, direct.stdout, direct.stderr) == (module.returncode, module.stdout, module.stderr)


def test_help_imports_nothing_heavy(tmp_path):
    """Why `cube-sim --help` answers at once: what takes time to load is not loaded."""
    program = (
        "import sys\nfrom cube_sim.commands.cli import main\nsys.argv = ['cube-sim', '--help']\n"
        "try:\n    main()\nfinally:\n"
        f"    print(*[name for name in {HEAVY!r} if name in sys.modules], file=sys.stderr)\n"
    )
    done = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0
    assert "Fly scenarios" in done.stdout
    assert done.stderr.split() == []


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["run"], "cube-sim run: missing argument 'SCENARIO'; "),
        (["signals", "a.yaml", "b.yaml"], "cube-sim signals: got unexpected extra argument"),
        (["run", "a.yaml", "--setings"], "cube-sim run: no such option: --setings (Possible options: --set); "),
        (["run", "a.yaml", "--out"], "cube-sim run: option '--out' requires an argument; "),
        (["run", "a.yaml", "--record", "all"], "cube-sim run: invalid value for '--record': 'all' is not one of"),
        (["plot", "a", "--width-mm", "wide"], "cube-sim plot: invalid value for '--width-mm': "),
        (
            ["view", "a", "--web", "--save", "a.rrd"],
            "cube-sim view: invalid value: --web shows the view and --save writes it: ",
        ),
        (
            ["export", "a", "b", "--format", "rrd", "--channel", "pose"],
            "cube-sim export: invalid value: --channel is of csv and ",
        ),
        (["fly"], "cube-sim: no such command 'fly'; cube-sim --help says what there is"),
        (["--quiet"], "cube-sim: no such option: --quiet; "),
    ],
)
def test_usage_errors_are_bad_input_and_one_line(monkeypatch, capsys, arguments, told):
    code, stdout, stderr = call(monkeypatch, capsys, *arguments)
    assert (code, stdout, stderr.count("\n")) == (2, "", 1)
    assert stderr.startswith(told)
    assert stderr.endswith(" --help says what there is\n")


def test_every_command_tells_a_usage_error_in_one_line(monkeypatch, capsys):
    _, listed, _ = call(monkeypatch, capsys, "--help")
    names = [line.split()[0] for line in listed.partition("Commands:")[2].partition("\n\n")[0].splitlines() if line]
    assert len(names) >= 14
    assert "..." not in listed.partition("Commands:")[2]  # each is told to its end
    for name in names:
        code, stdout, stderr = call(monkeypatch, capsys, name, "--no-such-option")
        assert (code, stdout, stderr.count("\n")) == (2, "", 1), name
        called = "new scenario" if name == "new" else name  # the word may be left out
        assert stderr.startswith(f"cube-sim {called}: no such option: --no-such-option")


def test_without_a_command_the_help_is_shown(monkeypatch, capsys):
    code, stdout, stderr = call(monkeypatch, capsys)
    assert (code, stdout) == (2, "")
    assert stderr.startswith("Usage: cube-sim [OPTIONS] COMMAND")
    assert "Fly scenarios" in stderr


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
@pytest.mark.parametrize("when", ["atexit.register(stop)", "schema.json_schema = stop"])
def test_every_command_ends_alike_by_a_signal(tmp_path, number, when):
    """Amid its work, and when all is said and the process ends."""
    program = (
        "import atexit, signal, sys\nfrom cube_sim.commands.cli import main\n"
        "import cube_sim.scenario.json_schema as schema\n"
        f"def stop():\n    signal.raise_signal({int(number)})\n"
        f"{when}\nsys.argv = ['cube-sim', 'schema']\nmain()\n"
    )
    command = [sys.executable, "-c", program]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=60, preexec_fn=interruptible)
    said = "interrupted" if number == signal.SIGINT else f"interrupted by {signal.Signals(number).name}"
    assert (done.returncode, done.stderr) == (128 + number, f"{said}\n")


@pytest.mark.parametrize("library", ["typer", "fcntl"])
def test_an_interrupt_amid_an_import_is_one_line(tmp_path, library):
    """Before the command line is loaded, and amid the module that claims a folder."""
    run = ["cube-sim", "run", str(write(tmp_path, FLIGHT))]
    program = (
        "import signal, sys\nfrom cube_sim.__main__ import main\n"
        "class Interrupts:\n    @staticmethod\n    def find_spec(name, *_):\n"
        f"        if name == {library!r}:\n            signal.raise_signal(signal.SIGINT)\n"
        f"assert {library!r} not in sys.modules\n"
        f"sys.meta_path.insert(0, Interrupts)\nsys.argv = {run!r}\nmain()\n"
    )
    command = [sys.executable, "-c", program]
    done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=60, preexec_fn=interruptible)
    assert (done.returncode, done.stdout, done.stderr) == (130, "", "interrupted\n")


def test_version_and_schema_are_printed(monkeypatch, capsys):
    assert call(monkeypatch, capsys, "--version") == (0, f"{version('cube-sim')}\n", "")
    assert call(monkeypatch, capsys, "schema") == (0, json_schema(), "")


@pytest.mark.parametrize(
    ("content", "arguments", "expected"),
    [
        (MINIMAL.replace("duration_s", "durtion_s"), [], ["mission.yaml:4:1: durtion_s: unknown key; did you mean"]),
        (MINIMAL.replace("hull", "hill"), [], ["mission.yaml:3:8: model: no such file: hill.xml"]),
        (MINIMAL.replace(": 10", ": -10"), [], ["mission.yaml:4:13: duration_s: must be greater than 0, got -10"]),
        (MINIMAL.replace("0.4", ".nan"), [], ["mission.yaml:6:23: guidance.speed_m_s: must be finite, got nan"]),
        (b"\x89MCAP0\r\n\x00\xff", [], ["mission.yaml:1:1: not UTF-8 text (byte 0x89)"]),
        (b"", [], ["mission.yaml:1:1: the file is empty"]),
        (MINIMAL, ["--set", "duration_s=-1"], ["override duration_s: must be greater than 0, got -1"]),
        (MINIMAL, ["--set", "duration_s"], ["--set duration_s: write PATH=VALUE, for example duration_s=60"]),
        (MINIMAL, ["--set", "seed=1", "--set", "seed=2"], ["--set seed=2: seed is set twice"]),
        (MINIMAL, ["--set", "seed=[1"], ["--set seed=[1: not valid YAML: "]),
        (MINIMAL, ["--out", "mission.yaml"], ["mission.yaml: cannot hold a recording: Not a directory"]),
        (MINIMAL, ["--out", "."], [".: holds hull.xml and 1 more, not from a run"]),
    ],
)  # fmt: skip
def test_bad_input_is_one_line_per_mistake_and_writes_nothing(
    tmp_path, monkeypatch, capsys, content, arguments, expected
):
    write(tmp_path, content)
    before = sorted(tmp_path.rglob("*"))
    monkeypatch.chdir(tmp_path)
    code, stdout, stderr = call(monkeypatch, capsys, "run", "mission.yaml", *arguments)
    lines = stderr.splitlines()
    assert (code, stdout, len(lines)) == (2, "", len(expected))
    for line, start in zip(lines, expected, strict=True):
        assert line.startswith(start)
    assert sorted(tmp_path.rglob("*")) == before


@pytest.mark.parametrize("path", ["none.yaml", "mission.yaml/below"])
def test_what_is_no_file_is_bad_input(tmp_path, monkeypatch, capsys, path):
    write(tmp_path)
    monkeypatch.chdir(tmp_path)
    code, stdout, stderr = call(monkeypatch, capsys, "run", path)
    assert (code, stdout, len(stderr.splitlines())) == (2, "", 1)
    assert stderr.startswith(f"{path}: ")


@pytest.mark.flight
def test_output_that_finds_no_room_is_one_line_and_changes_no_verdict(tmp_path):
    path = write(tmp_path, FLIGHT)
    out = fly(path, out=tmp_path / "out", record="mcap").directory
    failing = ("--record", "none", "--set", "checks.0.at_most=0.0", "--set", "initial.position_m=[0, 1, -5]")
    for arguments, code in (
        (("run", path, "--record", "none"), 0),
        (("run", path, *failing), 1),
        (("run", path, *failing, "--json"), 1),
        (("judge", out), 0),
        (("judge", out, "--json"), 0),
        (("diff", out, out), 0),
        (("schema",), 3),  # that was all there was to do
    ):
        with Path("/dev/full").open("w") as full:
            command = [sys.executable, "-m", "cube_sim", *map(str, arguments)]
            done = subprocess.run(command, cwd=tmp_path, stdout=full, stderr=subprocess.PIPE, text=True, timeout=120)
        assert (done.returncode, done.stderr) == (code, "the output cannot be written: No space left on device\n")


@pytest.mark.flight
def test_closed_streams_change_neither_the_code_nor_what_is_recorded(tmp_path):
    """`cube-sim judge RUN >&- 2>&-`, as a shell runs it."""
    path, out = write(tmp_path, FLIGHT), tmp_path / "out"
    every = (">&-", "2>&-", "<&- >&- 2>&-")
    ends = [
        (("schema",), 0, every[:1]),
        (("run", path, "--out", out, "--record", "mcap"), 0, every),
        (("judge", out), 0, every),
        (("run", path, "--record", "none", "--set", "checks.0.at_most=-1"), 1, every[:1]),
        (("export", out, tmp_path / "tables", "--channel", "pose"), 0, every[2:]),
        (("judge", tmp_path / "nothing"), 2, every[1:]),
    ]
    for arguments, code, closings in ends:
        command = shlex.join([sys.executable, "-m", "cube_sim", *map(str, arguments)])
        for closed in closings:
            done = subprocess.run(
                ["sh", "-c", f"{command} {closed}"], cwd=tmp_path, capture_output=True, text=True, timeout=300
            )
            assert (done.returncode, "Traceback" in done.stderr) == (code, False), (arguments, closed)


def test_what_a_library_prints_is_not_in_the_files_of_a_process_whose_streams_are_closed(tmp_path):
    program = (
        "from cube_sim.commands.ending import open_what_is_closed as opened; import os, subprocess; opened(); "
        "file = open('record', 'wb'); file.write(b'rows'); file.flush(); os.write(1, b'said'); os.write(2, b'said'); "
        "subprocess.run(['echo', 'said'], check=True); print('said', flush=True)"
    )
    command = f"{shlex.join([sys.executable, '-c', program])} <&- >&- 2>&-"
    assert subprocess.run(["sh", "-c", command], cwd=tmp_path, timeout=60).returncode == 0
    assert (tmp_path / "record").read_bytes() == b"rows"


def test_a_broken_pipe_is_not_a_traceback(tmp_path):
    """`cube-sim schema | head -1`, as a shell runs it."""
    command = [sys.executable, "-m", "cube_sim", "schema"]
    process = subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    process.stdout.close()
    assert process.stderr.read() == b""
    process.stderr.close()
    assert process.wait(timeout=60) == 128 + signal.SIGPIPE  # as of any program; 1 would say FAIL


# Flying


@pytest.mark.flight
def test_nothing_looks_for_windows_but_a_flight_of_own_code(tmp_path):
    """MuJoCo would, in a process of its own that says so when it is cut off."""
    out = fly(write(tmp_path, FLIGHT), out=tmp_path / "out", record="mcap").directory
    model = Path(__file__).parents[2] / "models" / "cube.xml"
    for arguments in (
        ("run", "mission.yaml", "--record", "none"),
        ("replay", out),
        ("export", out, "view", "--format", "rrd"),
        ("view", out, "--save", "view.rrd"),
        ("analyze", model),
    ):
        program = (
            "import sys\nfrom cube_sim.__main__ import main\n"
            f"sys.argv = {['cube-sim', *map(str, arguments)]!r}\n"
            "import atexit\n"
            "atexit.register(lambda: print('mujoco' in sys.modules, 'glfw' in sys.modules, file=sys.stderr))\nmain()\n"
        )
        surroundings = {name: value for name, value in os.environ.items() if name != "MUJOCO_GL"}
        command = [sys.executable, "-c", program]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, timeout=300, env=surroundings)
        assert (done.returncode, done.stderr.splitlines()[-1]) == (0, "True False"), arguments


@pytest.mark.flight
@pytest.mark.parametrize("more", [[], ["--json"]])
def test_what_was_found_is_told_by_the_code_whoever_reads_it(tmp_path, more):
    """`cube-sim run scenario.yaml | grep -q PASS`, which ends as soon as it has read that."""
    path, out = write(tmp_path, FLIGHT), tmp_path / "out"
    other = fly(path, {"guidance.speed_m_s": 0.11}, out=tmp_path / "other").directory
    for arguments, code in (
        (("run", path, "--out", out), 0),
        (("run", path, "--record", "none", "--set", "checks.0.at_most=-1"), 1),
        (("judge", out), 0),
        (("replay", out), 0),
        (("diff", out, other), 1),
        (("signals", path), 128 + signal.SIGPIPE),
    ):
        command = [sys.executable, "-m", "cube_sim", *map(str, arguments), *more]
        process = subprocess.Popen(command, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        process.stdout.close()
        said = without_compiling(process.stderr.read())
        process.stderr.close()
        assert (process.wait(timeout=120), said) == (code, ""), arguments


def test_pass_fail_and_error_have_their_exit_codes(tmp_path, monkeypatch, capsys):
    path, out = write(tmp_path, FLIGHT), tmp_path / "out"
    for code, verdict, settings in (
        (0, "PASS", []),
        (1, "FAIL", ["--set", "checks.0.at_most=-1"]),
        # Thrown so hard that the first step leaves all bounds.
        (3, "ERROR", ["--set", "initial.velocity_m_s=[1e5, 0, 0]"]),
    ):
        assert call(monkeypatch, capsys, "run", path, "--out", out, "--quiet", *settings) == (code, "", "")
        content = json.loads((out / "verdict.json").read_text())
        assert content["verdict"] == verdict
        assert sorted(item.name for item in out.iterdir()) == sorted(FILES)


def test_a_failed_check_decides_whatever_could_not_be_judged(tmp_path, monkeypatch, capsys):
    """One stuck thruster never makes the demand: exactness is not judged, the limit of the error fails all the same."""
    text = FLIGHT.replace("{kind: allowed_forces}", "{kind: exact_wrench}").replace("at_most: 0.05", "at_most: -1")
    path, out = write(tmp_path, text.replace("position_m: [0, 0, -5]", "position_m: [0, 90, -5]")), tmp_path / "out"
    stuck = "{kind: thrusters, at_s: 0, thrusters: [T1], state: stuck, force_N: 5}"
    lost = "{kind: thrusters, at_s: 0, thrusters: [T2, T3, T4, T5, T6, T7, T8], state: dead}"
    settings = ["--set", f"events=[{stuck}, {lost}]", "--set", "control.faults=told"]
    assert call(monkeypatch, capsys, "run", path, "--out", out, "--quiet", *settings) == (1, "", "")
    content = json.loads((out / "verdict.json").read_text())
    assert [check["verdict"] for check in content["checks"]] == ["FAIL", "ERROR"]


@pytest.mark.parametrize(
    ("error", "told"),
    [
        (ZeroDivisionError("a bug\nin two lines"), "ZeroDivisionError: a bug in two lines"),
        (EOFError("no more"), "EOFError: no more"),
        (EOFError(), "EOFError"),
        (MemoryError(), "MemoryError"),
        (SystemExit(0), "SystemExit: 0"),  # code of a user's own may end as it likes; that is no PASS
    ],
)
def test_what_nobody_foresaw_is_one_line_and_never_a_fail(tmp_path, monkeypatch, capsys, error, told):
    path = write(tmp_path, FLIGHT)

    def broken(*_, **__):
        raise error

    monkeypatch.setattr("cube_sim.simulation.fly", broken)
    line = f"unexpected {told} (CUBE_SIM_TRACEBACK=1 shows where)\n"
    assert call(monkeypatch, capsys, "run", path) == (3, "", line)
    monkeypatch.setenv("CUBE_SIM_TRACEBACK", "1")
    code, stdout, stderr = call(monkeypatch, capsys, "run", path)
    assert (code, stdout) == (3, "")
    assert stderr.startswith("Traceback (most recent call last):")


def files_no_larger_than(size):
    """What a new process calls first so that its files may not grow beyond so many bytes."""
    return lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size))


@pytest.mark.flight
def test_a_full_disk_is_one_line_and_could_not_be_judged(tmp_path):
    """A file may not grow beyond 100 kB: what a write meets on a full disk."""
    path, out = write(tmp_path, FLIGHT), tmp_path / "out"
    limit = files_no_larger_than(100_000)
    done = cube_sim("run", path, "--out", out, "--set", "duration_s=10", cwd=tmp_path, preexec_fn=limit)
    assert (done.returncode, done.stdout) == (3, "")
    assert done.stderr == f"{out}: cannot be written: File too large\n"
    told = json.loads((out / "verdict.json").read_text())
    assert (told["verdict"], told["ended_early"]["reason"]) == ("ERROR", "File too large")
    kept = load_run(out)
    assert kept.recorded_s > 0.5
    assert not kept.complete
    if kept.end is not None:  # there was room for it where the last second was not
        assert (kept.end.how, kept.end.reason) == ("failed", "File too large")
        assert kept.end.simulated_s >= kept.recorded_s


@pytest.mark.flight
def test_a_view_that_cannot_be_written_is_a_warning(tmp_path):
    """Of five seconds the record is 0.3 MB and the view 0.7 MB."""
    path, out = write(tmp_path, FLIGHT), tmp_path / "out"
    limit = files_no_larger_than(450_000)
    done = cube_sim("run", path, "--out", out, "--set", "duration_s=5", cwd=tmp_path, preexec_fn=limit)
    assert (done.returncode, done.stderr) == (0, "")
    assert "WARNING  run.rrd cannot be written: " in done.stdout
    assert not (out / "run.rrd").exists()  # no half of it
    assert load_run(out).complete


@pytest.mark.flight
@pytest.mark.parametrize(
    ("library", "number"),
    [
        ("_pydantic_core", signal.SIGINT),
        ("libmujoco", signal.SIGINT),
        ("llvmlite", signal.SIGINT),
        ("libmujoco", signal.SIGTERM),
        ("llvmlite", signal.SIGHUP),
    ],
)
def test_an_interrupt_while_starting_up_is_one_line(tmp_path, library, number):
    """A real signal when a certain library has just been loaded."""
    path, out = write(tmp_path, FLIGHT), tmp_path / "out"
    out.mkdir()
    for name in FILES:
        (out / name).write_text("of an earlier run")
    give_up = time.monotonic() + 300  # it may have to compile first
    with started("run", path, "--out", out, "--set", "duration_s=3600", cwd=tmp_path) as process:
        while library not in Path(f"/proc/{process.pid}/maps").read_text():
            assert time.monotonic() < give_up
            time.sleep(0.005)
        process.send_signal(number)
        stdout, stderr = process.communicate(timeout=60)
    assert (process.returncode, stdout) == (128 + number, "")
    said = "interrupted" if number == signal.SIGINT else f"interrupted by {signal.Signals(number).name}"
    assert stderr.startswith(said)
    assert len(stderr.splitlines()) == 1
    if stderr in (f"{said}\n", f"{said} while starting up; nothing is recorded\n"):
        assert sorted(each.name for each in out.iterdir()) == sorted(FILES)
        assert {each.read_text() for each in out.iterdir()} == {"of an earlier run"}
    else:  # it had begun to fly
        assert stderr == f"{said}; recorded so far: {out}\n"
        assert load_run(out).end.how == "interrupted"


def test_the_result_fits_a_screen_and_says_how_to_look_at_the_recording(tmp_path, monkeypatch, capsys):
    path, out = write(tmp_path, FLIGHT), tmp_path / "a folder"
    code, stdout, stderr = call(monkeypatch, capsys, "run", path, "--out", out, "--set", "checks.0.at_most=-1")
    assert (code, stderr) == (1, "")
    assert len(stdout.splitlines()) <= 24
    assert stdout.startswith("FAIL  short_flight: 0.5 s simulated")
    assert "max of path_error.cross_track" in stdout
    assert "FAIL max of path_error.cross_track: 26 samples" in " ".join(stdout.split())
    assert stdout.splitlines()[-1] == f"look at it: cube-sim view '{out}'"


def test_an_early_end_says_when_and_why(tmp_path, monkeypatch, capsys):
    """A speed that no vehicle has: nothing is flown."""
    path, out = write(tmp_path, FLIGHT), tmp_path / "out"
    arguments = ["run", path, "--out", out, "--set", "initial.velocity_m_s=[1e5, 0, 0]"]
    code, stdout, stderr = call(monkeypatch, capsys, *arguments)
    assert (code, stderr) == (3, "")
    lines = stdout.splitlines()
    assert lines[0].startswith("ERROR  short_flight: 0 of 0.5 s simulated")
    text = " ".join(stdout.split())
    assert "ended early, at 0 s: the acceleration of 'hull' is " in text
    assert "beyond 1e+06 before anything has moved (see to the current" in text
    (logged,) = (line for line in lines if line.startswith("  0.00 s  ERROR  the acceleration of 'hull' is "))
    assert logged.endswith(": the run ends here")

    content = json.loads(call(monkeypatch, capsys, *arguments, "--json")[1])
    assert content["ended_early"]["time_s"] == content["simulated_s"] == 0.0
    assert [entry["level"] for entry in content["log"]] == ["ERROR"]


def test_warnings_are_shown_a_line_each_with_their_time(tmp_path, monkeypatch, capsys):
    path, out = write(tmp_path, FLIGHT), tmp_path / "out"
    event = "{kind: thrusters, at_s: 0.2, thrusters: [T1, T2, T3, T4, T5, T6, T7, T8], state: dead}"
    arguments = ["run", path, "--out", out, "--set", f"events=[{event}]", "--set", "control.faults=told"]
    code, stdout, stderr = call(monkeypatch, capsys, *arguments)
    assert (code, stderr) == (0, "")
    _, log, _ = stdout.split("\n\n")[-3:]
    heading, *lines = log.splitlines()
    assert heading == "log:"
    assert lines[0] == "  0.20 s  WARNING  T1, T2, T3, T4, T5, T6, T7, T8: dead"
    (given_up,) = (line for line in lines if "the path is given up" in line)
    assert re.match(r"  0\.20 s  WARNING  the path is given up: .* it holds its position", given_up)
    assert call(monkeypatch, capsys, *arguments, "--quiet") == (0, "", "")


def test_json_is_the_verdict_and_where_it_is(tmp_path, monkeypatch, capsys):
    path, out = write(tmp_path, FLIGHT), tmp_path / "out"
    code, stdout, _ = call(monkeypatch, capsys, "run", path, "--out", out, "--json")
    content = json.loads(stdout)
    assert (code, content.pop("directory")) == (0, str(out))
    assert content == json.loads((out / "verdict.json").read_text())


def test_the_resolved_file_flies_the_same_run(tmp_path, monkeypatch, capsys):
    path, first, second = write(tmp_path, FLIGHT), tmp_path / "first", tmp_path / "second"
    call(monkeypatch, capsys, "run", path, "--out", first, "--set", "guidance.speed_m_s=0.3", "--quiet")
    resolved = first / "resolved.yaml"
    assert load(resolved).scenario == load(path, {"guidance.speed_m_s": 0.3}).scenario
    call(monkeypatch, capsys, "run", resolved, "--out", second, "--quiet")
    assert (second / "resolved.yaml").read_bytes() == resolved.read_bytes()
    checks = [json.loads((folder / "verdict.json").read_text())["checks"] for folder in (first, second)]
    assert checks[0] == checks[1]


def test_without_out_a_run_goes_to_logs(tmp_path, monkeypatch, capsys):
    path = write(tmp_path, FLIGHT)
    monkeypatch.chdir(tmp_path)
    assert call(monkeypatch, capsys, "run", path, "--quiet")[0] == 0
    (folder,) = (tmp_path / "logs").iterdir()
    assert folder.name.startswith("short_flight-")


@pytest.mark.parametrize("model", ["<mujoco/>", "<mujoco>", "not a model", ""])
def test_a_model_that_cannot_swim_is_bad_input(tmp_path, monkeypatch, capsys, model):
    path, out = write(tmp_path), tmp_path / "out"
    (tmp_path / "hull.xml").write_text(model)
    code, stdout, stderr = call(monkeypatch, capsys, "run", path, "--out", out)
    assert (code, stdout) == (2, "")
    assert str(tmp_path / "hull.xml") in stderr
    assert len(stderr.splitlines()) == 1
    assert not out.exists()


@pytest.mark.flight
def test_a_terminal_sees_progress_and_then_the_result(tmp_path):
    """On a real pseudo-terminal: the bar goes to it while flying, the table stays."""
    path, out = write(tmp_path, FLIGHT), tmp_path / "out"
    master, slave = pty.openpty()
    command = [sys.executable, "-m", "cube_sim", "run", str(path), "--out", str(out), "--set", "duration_s=3"]
    environment = {**os.environ, "TERM": "xterm-256color", "COLUMNS": "120", "LINES": "40"}
    process = subprocess.Popen(command, cwd=tmp_path, stdin=slave, stdout=slave, stderr=slave, env=environment)
    os.close(slave)
    seen = b""
    try:
        # Reading a terminal whose other side has closed is an error on Linux.
        with contextlib.suppress(OSError):
            while chunk := os.read(master, 65536):
                seen += chunk
        assert process.wait(timeout=60) == 0
    finally:
        process.kill()
        os.close(master)
    text = re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", seen.decode())
    assert re.search(r"short_flight .*[0-3] of 3 s simulated", text)
    assert re.search(r"[23] of 3 s simulated +\d+\.\d x real time", text)
    assert text.index("of 3 s simulated") < text.index("PASS  short_flight: 3 s simulated")


@pytest.mark.flight
@pytest.mark.parametrize(
    ("number", "code", "told"),
    [(signal.SIGINT, 130, "Ctrl-C"), (signal.SIGTERM, 143, "SIGTERM"), (signal.SIGHUP, 129, "SIGHUP")],
)
def test_an_interrupted_run_closes_its_recording(tmp_path, number, code, told):
    """A real signal in the middle of an hour's flight."""
    path, out = write(tmp_path, FLIGHT), tmp_path / "out"
    with started("run", path, "--out", out, "--set", "duration_s=3600", cwd=tmp_path) as process:
        recording = out / "run.mcap"
        give_up = time.monotonic() + 300  # it may have to compile first
        while not (recording.exists() and recording.stat().st_size > 100_000):
            assert process.poll() is None, process.communicate()
            assert time.monotonic() < give_up, "the run did not begin to record"
            time.sleep(0.05)
        process.send_signal(number)
        stdout, stderr = process.communicate(timeout=30)
    assert (process.returncode, stdout) == (code, "")
    by = "" if number == signal.SIGINT else f" by {told}"
    assert stderr == f"interrupted{by}; recorded so far: {out}\n"
    kept = load_run(out)
    assert len(kept.signals["pose.position"]) > 50
    assert (kept.end.how, kept.end.reason, kept.end.verdict) == ("interrupted", told, "ERROR")
    assert kept.end.simulated_s == pytest.approx(kept.recorded_s, abs=0.021)
    assert kept.told["ended_early"]["reason"] == f"interrupted by {told}"
    with recording.open("rb") as file:  # an indexed file, as any finished one
        assert make_reader(file).get_summary() is not None


@pytest.mark.flight
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_a_signal_upon_the_first_second_recorded_closes_the_recording(tmp_path, number):
    path, out = write(tmp_path, FLIGHT), tmp_path / "out"
    give_up = time.monotonic() + 300  # it may have to compile first
    with started("run", path, "--out", out, "--set", "duration_s=3600", cwd=tmp_path) as process:
        while not (out / "run.mcap").exists():
            assert process.poll() is None, process.communicate()
            assert time.monotonic() < give_up, "the run did not begin to record"
        process.send_signal(number)
        _, stderr = process.communicate(timeout=30)
    assert process.returncode == 128 + number
    assert stderr.endswith(f"; recorded so far: {out}\n")
    assert load_run(out).end.how == "interrupted"
    assert (out / "verdict.json").exists()


@pytest.mark.flight
@pytest.mark.parametrize("kept", ["mcap", "none"])
def test_a_signal_once_the_run_is_over_takes_nothing_from_it_and_says_so(tmp_path, monkeypatch, capsys, kept):
    path, out = write(tmp_path, FLIGHT), tmp_path / "out"
    write_verdict = simulation.write_verdict

    def signalled(*told):
        os.kill(os.getpid(), signal.SIGTERM)
        write_verdict(*told)

    monkeypatch.setattr(simulation, "write_verdict", signalled)
    code, stdout, stderr = call(monkeypatch, capsys, "run", path, "--out", out, "--record", kept)
    assert (code, stdout) == (143, "")
    assert stderr == f"interrupted by SIGTERM once the run was over; it is whole, and judged: {out}\n"
    assert json.loads((out / "verdict.json").read_text())["verdict"] == "PASS"
    assert kept == "none" or load_run(out).complete


@pytest.mark.flight
def test_an_interrupted_run_says_what_it_had_warned_of(tmp_path, monkeypatch, capsys):
    """Whoever stops a flight wants to know why it went astray."""
    path, out = write(tmp_path, FLIGHT), tmp_path / "out"
    dead = "events=[{kind: thrusters, at_s: 0, thrusters: [T1], state: dead}]"

    def interrupted():
        raise KeyboardInterrupt

    monkeypatch.setattr("cube_sim.commands.progress.raise_on_interrupt", interrupted)
    code, stdout, stderr = call(monkeypatch, capsys, "run", path, "--out", out, "--set", dead)
    assert (code, stdout) == (130, "")
    assert stderr == f"0.00 s  WARNING  T1: dead\ninterrupted; recorded so far: {out}\n"
    code, _, stderr = call(monkeypatch, capsys, "run", path, "--out", out, "--set", dead, "--record", "none")
    assert (code, stderr) == (130, "0.00 s  WARNING  T1: dead\ninterrupted\n")


@pytest.mark.flight
def test_a_run_without_a_record_speaks_of_its_verdict_alone(tmp_path, monkeypatch, capsys):
    path, out = write(tmp_path, FLIGHT), tmp_path / "out"
    _, stdout, _ = call(monkeypatch, capsys, "run", path, "--out", out, "--record", "none")
    assert stdout.splitlines()[-1] == f"verdict: {out}"
    _, stdout, _ = call(monkeypatch, capsys, "run", path, "--out", out, "--record", "mcap")
    assert stdout.splitlines()[-1] == f"recording: {out}"
