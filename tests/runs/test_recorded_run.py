"""A run read back, flown again from its record alone, compared, judged and handed on, as the commands do it."""

from __future__ import annotations

import json
import re
import shutil
import signal
from dataclasses import replace
from importlib import import_module

import numpy as np
import pyarrow.parquet
import pytest
from mcap.reader import make_reader
from support.command_line import call
from support.laundering import written_anew
from support.own_code import scenario_with

import cube_sim
from cube_sim.errors import RecordingError, RunInterrupted, UnknownSignalError
from cube_sim.runs import tables
from cube_sim.scenario.loading import loaded_again
from cube_sim.verdict import EarlyEnd

pytestmark = pytest.mark.flight


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    folder = tmp_path_factory.mktemp("flown")
    return cube_sim.run(scenario_with(folder, ""), {"duration_s": 3.0}, folder / "run")


def interrupted_after(write):
    """The same, and Ctrl-C behind it."""

    def write_and_interrupt(*arguments):
        result = write(*arguments)
        signal.raise_signal(signal.SIGINT)
        return result

    return write_and_interrupt


@pytest.fixture(scope="module")
def other(tmp_path_factory):
    folder = tmp_path_factory.mktemp("other")
    return cube_sim.run(scenario_with(folder, ""), {"duration_s": 3.0, "guidance.speed_m_s": 0.41}, folder / "run")


def cut(flown, tmp_path, share=0.6):
    """The same run, its writer killed."""
    folder = tmp_path / "cut"
    folder.mkdir()
    whole = (flown.directory / "run.mcap").read_bytes()
    (folder / "run.mcap").write_bytes(whole[: int(share * len(whole))])
    return folder


def test_it_has_what_the_run_had(flown):
    run = cube_sim.load_run(flown.directory)
    assert run.complete
    assert run.scenario.guidance.speed_m_s == 0.4
    assert run.scenario.duration_s == run.recorded_s == 3.0
    assert run.verdict == run.told["verdict"] == flown.verdict == "PASS"
    assert run.checks == flown.checks
    assert {check.unit for check in run.checks} <= {"m", "N", "N, N m"}
    assert run.signals.keys() == flown.signals.keys() == run.fields.keys()
    for name, rows in flown.signals.items():
        assert run.signals[name].tobytes() == rows.tobytes(), name
        assert len(run.column_names(name)) == rows.shape[1] - 1
    assert run.column_names("wrench.demanded")[2:4] == ("wrench.demanded.Fz [N]", "wrench.demanded.Mx [N m]")
    assert run.column_names("path_error.cross_track") == ("path_error.cross_track [m]",)
    assert cube_sim.load_run(flown.directory / "run.mcap").told == run.told
    assert run.versions.keys() >= flown.versions.keys()
    assert (run.how, run.ended_early, run.simulated_s) == ("completed", None, flown.simulated_s)
    assert run.build.startswith(f"source {run.versions['cube-sim source'][:12]}")
    for each in (run, run.recording, flown):
        assert len(repr(each)) < 200 + len(str(run.path))
        assert "\n" not in repr(each)
        assert each == each
        assert each != cube_sim.load_run(flown.directory)
        assert each in {each}
    assert repr(run) == f"<RecordedRun short_flight: PASS, completed, 3 s: {run.path}>"


def test_what_is_no_run_is_refused(tmp_path, flown):
    with pytest.raises(RecordingError, match="no such file"):
        cube_sim.load_run(tmp_path / "none.mcap")
    with pytest.raises(RecordingError, match=r"is not the folder of a run: there is no run\.mcap in it"):
        cube_sim.load_run(tmp_path)
    with pytest.raises(RecordingError, match=r"^/dev/null: is not a regular file, no record$"):
        cube_sim.load_run("/dev/null")
    (tmp_path / "verdict.json").write_text("{}")
    with pytest.raises(
        RecordingError, match=r"is the folder of a run without a record: there is a verdict and no run\.m"
    ):
        cube_sim.load_run(tmp_path)
    shutil.copy(flown.directory / "run.mcap", tmp_path)
    (tmp_path / "verdict.json").write_text("{")
    with pytest.raises(RecordingError, match=r"verdict\.json: cannot be read"):
        cube_sim.load_run(tmp_path)


def test_a_name_that_is_none_is_told_with_the_nearest(flown):
    run = cube_sim.load_run(flown.directory)
    for table in (run.signals, run.fields, flown.signals):
        with pytest.raises(UnknownSignalError) as caught:
            table["pose.positon"]
        assert isinstance(caught.value, KeyError)
        assert str(caught.value) == "no signal 'pose.positon'; did you mean pose.position?"
        assert "pose.positon" not in table
        assert table.get("pose.positon") is None


def test_a_check_on_what_was_not_modelled_says_why(flown, tmp_path, monkeypatch, capsys):
    checks = tmp_path / "checks.yaml"
    asked = ("power.charge", "the scenario has no battery"), ("sensor_dvl.outcome", "the scenario has no sensor 'dvl'")
    checks.write_text(
        "checks:\n" + "".join(f"  - {{kind: signal, signal: {s}, statistic: min, at_least: 0.2}}\n" for s, _ in asked)
    )
    code, out, _ = call(monkeypatch, capsys, "judge", flown.directory, "--checks", checks, "--json")
    assert code == 3
    assert [check["detail"] for check in json.loads(out)["checks"]] == [
        f"{s} is not recorded: {why}" for s, why in asked
    ]


def test_a_replay_is_identical(flown, monkeypatch, capsys):
    code, out, err = call(monkeypatch, capsys, "replay", flown.directory, "--quiet")
    assert (code, out, err) == (0, "", "")
    code, out, err = call(monkeypatch, capsys, "replay", flown.directory, "--json")
    assert (code, json.loads(out)["identical"], json.loads(out)["signals"]) == (0, True, len(flown.signals))


def test_a_replay_needs_nothing_but_the_record(flown, tmp_path, monkeypatch, capsys):
    shutil.copy(flown.directory / "run.mcap", tmp_path / "alone.mcap")
    code, out, _ = call(monkeypatch, capsys, "replay", tmp_path / "alone.mcap")
    assert code == 0
    assert out == f"identical: {len(flown.signals)} signals and 2 lines of log, to 3 s\n"


def test_a_record_cut_short_is_replayed_as_far_as_it_goes(flown, tmp_path, monkeypatch, capsys):
    code, out, _ = call(monkeypatch, capsys, "replay", cut(flown, tmp_path))
    assert code == 0
    assert out.startswith("identical: ")
    assert "as far as the record goes" in out
    assert float(out.split("to ")[1].split(" s")[0]) < 2.5


def test_an_interrupted_run_is_replayed_as_far_as_it_goes(tmp_path, monkeypatch, capsys):
    def interrupt(t, _):
        if t >= 1.0:
            raise KeyboardInterrupt

    with pytest.raises(RunInterrupted):
        cube_sim.run(scenario_with(tmp_path, ""), {"duration_s": 3.0}, tmp_path / "run", interrupt)
    run = cube_sim.load_run(tmp_path / "run")
    assert not run.complete
    assert run.flaw == f"interrupted at {run.end.simulated_s:g} s: Ctrl-C"
    assert run.ended_early == EarlyEnd(run.end.simulated_s, "interrupted by Ctrl-C")
    told = json.loads((tmp_path / "run" / "verdict.json").read_text())
    assert (told["verdict"], told["ended_early"]["reason"]) == ("ERROR", "interrupted by Ctrl-C")
    assert run.end.verdict == "ERROR"
    assert 1.0 <= run.end.simulated_s == told["simulated_s"] < 3.0
    assert {check["verdict"] for check in told["checks"]} == {"ERROR"}
    code, out, _ = call(monkeypatch, capsys, "replay", tmp_path / "run")
    assert code == 0
    assert out.startswith("identical: ")
    assert out.endswith(f"to {run.recorded_s:g} s, as far as the record goes\n")


def another_speed(controller_of):
    """As if another version of the program flew."""
    return lambda loaded, *rest: controller_of(loaded_again(loaded, {"guidance.speed_m_s": 0.39}), *rest)


def test_a_replay_that_differs_says_where_first(flown, monkeypatch, capsys):
    prepare = import_module("cube_sim.mission.prepare")
    monkeypatch.setattr(prepare, "controller_of", another_speed(prepare.controller_of))
    code, out, _ = call(monkeypatch, capsys, "replay", flown.directory)
    assert code == 1
    assert out.startswith("differs: ")
    assert "first: " in out


def test_diff_names_signals_and_keeps_to_tolerances(flown, other, monkeypatch, capsys):
    code, out, _ = call(monkeypatch, capsys, "diff", flown.directory, flown.directory / "run.mcap")
    assert (code, out) == (0, f"the same: {len(flown.signals)} signals\n")
    code, out, _ = call(monkeypatch, capsys, "diff", flown.directory, other.directory, "--json")
    told = json.loads(out)
    found = {each["signal"]: each for each in told["signals"]}
    assert code == 1
    assert told["settings"] == [{"key": "guidance.speed_m_s", "one": "0.4", "other": "0.41"}]
    assert told["files"] == []
    assert "path.position" not in found
    assert (
        found["pose.position"]["largest"]
        == np.abs(flown.signals["pose.position"] - other.signals["pose.position"]).max()
    )
    code, out, _ = call(monkeypatch, capsys, "diff", flown.directory, other.directory, "--tolerance", "1e9")
    told = f"setting guidance.speed_m_s: 0.4 against 0.41\nthe same: {len(flown.signals)} signals\n"
    assert (code, out) == (0, told)
    code, out, _ = call(monkeypatch, capsys, "diff", flown.directory, other.directory, "--tolerance", "pose=1e9")
    assert code == 1
    assert "pose." not in out
    assert "target.arc_length" in out


@pytest.mark.parametrize(
    ("argument", "told"),
    [
        ("pose.positon=1", "did you mean pose.position?"),
        ("x", "write SIGNAL"),
        ("=1", "write SIGNAL"),
        ("inf", "write SIGNAL=NUMBER, 0 or more and finite"),
        ("pose=nan", "write SIGNAL"),
    ],
)
def test_a_tolerance_that_is_none_is_one_line(argument, told, flown, monkeypatch, capsys):
    code, out, err = call(monkeypatch, capsys, "diff", flown.directory, flown.directory, "--tolerance", argument)
    assert (code, out, err.count("\n")) == (2, "", 1)
    assert told in err


def test_diff_says_that_a_record_ends_early(flown, tmp_path, monkeypatch, capsys):
    short = cut(flown, tmp_path)
    code, _, err = call(monkeypatch, capsys, "diff", flown.directory, short)
    assert (code, err.count("\n")) == (1, 1)
    assert err.startswith(f"{short / 'run.mcap'}: the record ends early, at ")


def test_judged_again_the_verdict_is_the_same(flown, monkeypatch, capsys):
    code, out, _ = call(monkeypatch, capsys, "judge", flown.directory, "--json")
    told = json.loads(out)
    assert (code, told["verdict"], told["remarks"]) == (0, "PASS", [])
    kept = json.loads((flown.directory / "verdict.json").read_text())
    assert told["checks"] == kept["checks"]


def test_other_checks_judge_it_otherwise(flown, tmp_path, monkeypatch, capsys):
    checks = tmp_path / "checks.yaml"
    checks.write_text("checks:\n  - {kind: path_end, reach_m: 0.01}\n  - {kind: allowed_forces}\n")
    code, out, _ = call(monkeypatch, capsys, "judge", flown.directory, "--checks", checks, "--json")
    assert (code, [each["verdict"] for each in json.loads(out)["checks"]]) == (1, ["FAIL", "PASS"])
    checks.write_text("checks:\n  - {kind: path_end, reach: 0.01}\n")
    code, out, err = call(monkeypatch, capsys, "judge", flown.directory, "--checks", checks)
    assert (code, out) == (2, "")
    assert f"{checks}:2:" in err
    assert "did you mean reach_m?" in err
    checks.write_text("checks:\n  - {kind: signal, signal: pose.positon, statistic: max, at_most: 1}\n")
    code, _, err = call(monkeypatch, capsys, "judge", flown.directory, "--checks", checks)
    said = "checks.0.signal: no signal 'pose.positon' is recorded, did you mean pose.position?"
    assert (code, err) == (2, f"{checks}:2:28: {said}\n")
    # No battery and no navigation: neither is there to be meant.
    for meant in ("power.charg", "navigation.positions", "foo.bar"):
        checks.write_text(f"checks:\n  - {{kind: signal, signal: {meant}, statistic: max, at_most: 1}}\n")
        code, _, err = call(monkeypatch, capsys, "judge", flown.directory, "--checks", checks)
        told = err.partition("is recorded, ")[2].removeprefix("did you mean ").rpartition(" are ")[2].strip("?\n")
        assert (code, err.count("\n"), told != "") == (2, 1, True)
        assert set(told.split(", ")) <= set(cube_sim.load_run(flown.directory).fields)
    checks.write_text("name: x\n")
    code, _, err = call(monkeypatch, capsys, "judge", flown.directory, "--checks", checks)
    assert (code, err) == (2, f"{checks}:1:1: checks: is missing; give a list of checks\n")
    for text, told in (
        (
            "- {kind: path_end, reach_m: 1}\n",
            ":1:1: a file of checks is a block of keys with checks: in it, this file holds",
        ),
        ("seed: 1\nchekcs: []\n", ":2:1: chekcs: unknown key; did you mean checks?"),
        ("checks: []\nzzz: 1\n", ":2:1: zzz: unknown key; known: checks, and those of a scenario"),
        (
            "checks:\n  - {kind: path_end, reach_m: 1, far: 2}\n",
            ":2:34: checks.0.far: unknown key; known: name, kind, reach_m",
        ),
    ):
        checks.write_text(text)
        code, out, err = call(monkeypatch, capsys, "judge", flown.directory, "--checks", checks)
        assert (code, out, err.count("\n")) == (2, "", 1)
        assert err.startswith(f"{checks}{told}")
    code, out, err = call(monkeypatch, capsys, "judge", flown.directory, "--checks", tmp_path)
    assert (code, out, err) == (2, "", f"{tmp_path}: is a folder, not a file of checks\n")


def test_a_record_cut_short_is_never_a_pass(flown, tmp_path, monkeypatch, capsys):
    code, out, _ = call(monkeypatch, capsys, "judge", cut(flown, tmp_path), "--json")
    assert (code, json.loads(out)["verdict"]) == (3, "ERROR")
    assert "the record ends early" in json.loads(out)["remarks"][0]


def test_tables_of_a_record_cut_short_are_said_to_end_early(flown, tmp_path, monkeypatch, capsys):
    code, _, told = call(monkeypatch, capsys, "export", cut(flown, tmp_path), tmp_path / "tables")
    assert (code, "run.mcap: the record ends early, at " in told) == (0, True)
    assert call(monkeypatch, capsys, "export", flown.directory, tmp_path / "whole")[2] == ""


def test_exported_numbers_are_the_same_bits(flown, tmp_path, monkeypatch, capsys):
    for kind in ("csv", "parquet"):
        code, out, _ = call(monkeypatch, capsys, "export", flown.directory, tmp_path / kind, "--format", kind)
        assert code == 0
        assert f"wrench.{kind}" in out
    wrench = flown.signals["wrench.allocated"]
    lines = (tmp_path / "csv" / "wrench.csv").read_text().splitlines()
    assert lines[0].split(",")[:2] == ["t [s]", "demanded.Fx [N]"]
    read = np.array([[float(number) for number in line.split(",")] for line in lines[1:]])
    words = (tmp_path / "csv" / "allocation.csv").read_text().splitlines()
    assert words[0].split(",")[3:5] == ["status [1]", "status [name]"]
    assert words[1].split(",")[3:5] == ["0.0", "EXACT"]
    codes = pyarrow.parquet.read_table(tmp_path / "parquet" / "allocation.parquet").column("status [name]")
    assert set(codes.to_pylist()) == {"EXACT"}
    assert read[:, 7:13].tobytes() == np.ascontiguousarray(wrench[:, 1:]).tobytes()
    table = pyarrow.parquet.read_table(tmp_path / "parquet" / "wrench.parquet")
    assert table.column("allocated.Mz [N m]").to_numpy().tobytes() == np.ascontiguousarray(wrench[:, 6]).tobytes()
    code, out, _ = call(
        monkeypatch, capsys, "export", flown.directory, tmp_path / "one", "--channel", "pose", "--channel", "wrench"
    )
    assert len(out.splitlines()) == 2
    code, _, err = call(monkeypatch, capsys, "export", flown.directory, tmp_path / "two", "--channel", "poise")
    assert (code, "no such channel; there are" in err) == (2, True)
    code, _, err = call(monkeypatch, capsys, "export", flown.directory, tmp_path / "one")
    assert (code, err) == (2, f"{tmp_path / 'one'}: is not an empty folder\n")


def test_an_export_that_is_interrupted_leaves_nothing(flown, tmp_path, monkeypatch, capsys):
    place = tmp_path / "tables"
    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # what runs in the background may ignore it
    with monkeypatch.context() as patch:
        patch.setattr(tables, "write_csv", interrupted_after(tables.write_csv))
        code, out, err = call(monkeypatch, capsys, "export", flown.directory, place)
    signal.signal(signal.SIGINT, before)
    assert (code, out, err) == (130, "", f"{place}: interrupted, nothing is written\n")
    assert not place.exists()
    assert call(monkeypatch, capsys, "export", flown.directory, place)[0] == 0


def test_exported_inputs_fly(flown, tmp_path, monkeypatch, capsys):
    call(monkeypatch, capsys, "export", flown.directory, tmp_path / "inputs", "--format", "inputs")
    again = cube_sim.run(tmp_path / "inputs" / "resolved.yaml", out=tmp_path / "again")
    assert again.signals["pose.position"].tobytes() == flown.signals["pose.position"].tobytes()
    call(monkeypatch, capsys, "export", flown.directory, tmp_path / "view", "--format", "rrd")
    assert (tmp_path / "view" / "run.rrd").stat().st_size > 10_000


def test_a_scenario_of_another_version_is_one_line(flown, monkeypatch, capsys):
    run = cube_sim.load_run(flown.directory)
    header = replace(run.header, resolved=run.header.resolved.replace("guidance:", "steering:"))
    for module in ("reading", "one_pass"):
        monkeypatch.setattr(f"cube_sim.recording.{module}.read_header", lambda _: (header, run.recording.vehicle))
    other = cube_sim.load_run(flown.directory)
    with pytest.raises(RecordingError, match=r"run\.mcap: its scenario is none of this version: "):
        assert other.scenario
    for command in ("replay", "judge", "report"):
        code, out, err = call(monkeypatch, capsys, command, flown.directory)
        assert (code, out, err.count("\n")) == (2, "", 1), (command, err)


def test_what_is_left_of_a_damaged_record_is_recovered(flown, tmp_path, monkeypatch, capsys):
    folder = tmp_path / "damaged"
    folder.mkdir()
    data = bytearray((flown.directory / "run.mcap").read_bytes())
    places = [k for k in range(len(data)) if data[k : k + 8] == b"\x04\0\0\0zstd"]
    data[places[1] - 2] ^= 4  # its checksum
    (folder / "run.mcap").write_bytes(data)
    code, _, err = call(monkeypatch, capsys, "judge", folder)
    assert (code, err.count("\n"), "from 1 s to 1.98 s" in err, "`cube-sim recover`" in err) == (2, 1, True, True)
    code, out, err = call(monkeypatch, capsys, "recover", folder)
    saved = tmp_path / "damaged_recovered"
    assert (code, err) == (0, "")
    assert out.splitlines() == [
        f"recovered up to 3 s: {saved}",
        "  dropped: the chunk from 1 s to 1.98 s does not fit its checksum",
        "  missing: 1 s to 2 s: 50 of 151 rows each of every channel",
    ]
    assert (saved / "run.rrd").stat().st_size > 10_000
    with (saved / "run.mcap").open("rb") as stream:
        drawn = {channel.topic for _, channel, _ in make_reader(stream).iter_messages()}
    assert {"/scene", "/scene/path", "/scene/trail", "/scene/thrust", "/tf", "/tf/target"} <= drawn
    run = cube_sim.load_run(saved)
    assert (run.complete, run.end.how, run.end.missing_s) == (False, "recovered", ((1.0, 2.0),))
    assert run.flaw == "recovered: the chunk from 1 s to 1.98 s does not fit its checksum"
    pose = flown.signals["pose.position"]
    assert run.signals["pose.position"].tobytes() == pose[(pose[:, 0] < 1.0) | (pose[:, 0] >= 2.0)].tobytes()
    code, out, _ = call(monkeypatch, capsys, "replay", saved)
    assert (code, out.startswith("identical")) == (0, True)
    code, out, err = call(monkeypatch, capsys, "recover", saved)
    told = f"{saved / 'run.mcap'}: is a recovered record already; there is nothing more to recover in it\n"
    assert (code, out, err) == (0, told, "")
    assert call(monkeypatch, capsys, "recover", tmp_path / "nope") == (2, "", f"{tmp_path / 'nope'}: no such file\n")
    code, out, _ = call(monkeypatch, capsys, "judge", saved, "--json")
    assert (code, json.loads(out)["verdict"]) == (3, "ERROR")
    checks = tmp_path / "checks.yaml"
    checks.write_text("checks:\n  - {kind: signal, signal: pose.position, statistic: max, at_most: 1}\n")
    code, out, _ = call(monkeypatch, capsys, "judge", saved, "--checks", checks, "--json")
    assert (code, json.loads(out)["verdict"]) == (1, "FAIL")


def test_a_channel_that_is_gone_and_rows_that_are_gone_are_named(flown, tmp_path, monkeypatch, capsys):
    """As a tool that filters topics leaves a file: nothing in it is damaged."""
    record = written_anew(
        flown.directory / "run.mcap",
        target=tmp_path / "some.mcap",
        keep=lambda found: found[1].topic != "/wrench" and not (found[1].topic == "/pose" and found[2].sequence == 7),
        left_out={"/wrench"},
    )
    code, out, _ = call(monkeypatch, capsys, "recover", record)
    lines = out.splitlines()
    assert (code, lines[0]) == (0, f"recovered up to 3 s: {tmp_path / 'some_recovered'}")
    told = ["0 s to 3 s: all 151 rows of wrench", "0.14 s to 0.16 s: 1 of 151 rows of pose"]
    assert sorted(lines[1:]) == sorted(f"  missing: {each}" for each in told)
    run = cube_sim.load_run(tmp_path / "some_recovered")
    assert run.end.reason == "; ".join(told[::-1])
    assert {loss.channel: loss.rows for loss in run.losses} == {"wrench": 151, "pose": 1}
    checks = tmp_path / "checks.yaml"
    by = "  - {kind: signal, name: below %s m, signal: pose.position, statistic: max, at_most: %s}\n"
    checks.write_text("checks:\n" + by % (99, 99) + by % (1, 1))
    code, out, _ = call(monkeypatch, capsys, "judge", tmp_path / "some_recovered", "--checks", checks, "--json")
    assert (code, [each["verdict"] for each in json.loads(out)["checks"]]) == (1, ["ERROR", "FAIL"])


def test_a_record_that_lacks_its_last_words_alone_does_not_end_early(flown, tmp_path):
    record = tmp_path / "cut.mcap"
    whole = (flown.directory / "run.mcap").read_bytes()
    record.write_bytes(whole[: whole.index(b"\x03\0\0\0end") - 9])
    run = cube_sim.load_run(record)
    assert run.recorded_s == 3.0
    assert run.flaw == "its rows go to the end, 3 s, but it does not say how the run ended"


def test_two_records_in_one_file_are_no_complete_record_for_anybody(flown, tmp_path, monkeypatch, capsys):
    twice = tmp_path / "twice.mcap"
    twice.write_bytes((flown.directory / "run.mcap").read_bytes() * 2)
    assert call(monkeypatch, capsys, "judge", twice)[0] == 2
    code, out, _ = call(monkeypatch, capsys, "recover", twice)
    assert (code, "complete" in out, "dropped: what comes after the record's end" in out) == (0, False, True)
    saved = cube_sim.load_run(tmp_path / "twice_recovered")
    assert (saved.complete, saved.recorded_s, saved.losses) == (False, 3.0, ())


def test_what_a_record_was_refused_for_is_told_where_all_of_its_rows_are_sound(flown, tmp_path, monkeypatch, capsys):
    """A single bit of the name of the library that wrote it, which no checksum but that of the whole holds."""
    record, data = tmp_path / "bit.mcap", bytearray((flown.directory / "run.mcap").read_bytes())
    profile = int.from_bytes(data[17:21], "little")
    data[21 + profile + 4] ^= 1
    record.write_bytes(data)
    refused = f"{record} is damaged: its contents do not fit their checksum"
    code, _, err = call(monkeypatch, capsys, "judge", record)
    assert (code, refused in err) == (2, True)
    code, out, err = call(monkeypatch, capsys, "recover", record)
    saved = tmp_path / "bit_recovered"
    assert (code, err) == (0, "")
    assert out.splitlines() == [f"recovered up to 3 s: {saved}", f"  refused as it was: {refused}"]
    assert cube_sim.load_run(saved).flaw == f"recovered: {refused}"


def test_a_complete_record_without_the_last_bytes_of_its_summary_is_left_alone(flown, tmp_path, monkeypatch, capsys):
    short = tmp_path / "short.mcap"
    short.write_bytes((flown.directory / "run.mcap").read_bytes()[:-100])
    assert cube_sim.load_run(short).complete
    code, out, _ = call(monkeypatch, capsys, "recover", short)
    assert (code, "is complete; there is nothing to recover" in out) == (0, True)
    assert not (tmp_path / "short_recovered").exists()


def test_what_a_kill_left_is_recovered_and_what_is_whole_is_left_alone(flown, tmp_path, monkeypatch, capsys):
    code, out, _ = call(monkeypatch, capsys, "recover", cut(flown, tmp_path), "--out", tmp_path / "saved")
    assert code == 0
    assert re.fullmatch(r"  missing: [12] s to 3 s: \d+ rows each of every channel", out.splitlines()[-1])
    saved = cube_sim.load_run(tmp_path / "saved")
    assert saved.recorded_s < 2.5
    assert (saved.how, saved.ended_early.time_s) == ("recovered", saved.recorded_s)
    cut_off = cube_sim.load_run(tmp_path / "cut")
    assert (cut_off.how, cut_off.ended_early) == (None, EarlyEnd(saved.recorded_s, cut_off.flaw))
    assert "not judged, without an end" in repr(cut_off)
    code, out, _ = call(monkeypatch, capsys, "recover", flown.directory, "--output", tmp_path / "none")
    assert (code, "is complete; there is nothing to recover" in out) == (0, True)
    assert not (tmp_path / "none").exists()
    (tmp_path / "head").mkdir()
    (tmp_path / "head" / "run.mcap").write_bytes((flown.directory / "run.mcap").read_bytes()[:300])
    code, out, err = call(monkeypatch, capsys, "recover", tmp_path / "head")
    assert (code, out, err.count("\n")) == (2, "", 1)


def test_signals_are_made_when_they_are_asked_for(flown):
    run = cube_sim.load_run(flown.directory)
    whole = run.recording.signals
    assert list(run.signals) == list(whole)
    assert len(run.signals) == len(whole)
    assert "pose.position" in run.signals
    assert "pose.place" not in run.signals
    assert not run.signals._made
    for name, rows in whole.items():
        assert np.array_equal(run.signals[name], rows, equal_nan=True)
        assert run.signals[name] is run.signals[name]
    assert run.signals.get("pose.place") is None
