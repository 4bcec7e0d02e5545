"""A recording is whole: with every source deleted and the folder moved, what it holds flies again to the same bytes."""

from __future__ import annotations

import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader
from mcap.writer import Writer
from support.command_line import call
from support.own_code import PID, scenario_with
from support.places import CUBE

import cube_sim
from cube_sim.errors import RecordingError
from cube_sim.recording.channels import Channel
from cube_sim.recording.export import rrd_from_mcap
from cube_sim.recording.mcap.fixed_width import channel_layout, packed_layout
from cube_sim.recording.reading import CANNOT_KNOW, read_recording
from cube_sim.recording.saved_inputs import save_inputs
from cube_sim.runs.replay import replay
from cube_sim.scenario import load

CORNERS = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
FACES = ["1 3 4", "1 4 2", "5 6 8", "5 8 7", "1 2 6", "1 6 5", "3 7 8", "3 8 4", "1 5 7", "1 7 3", "2 4 8", "2 8 6"]
OBJ = "".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS) + "".join(f"f {face}\n" for face in FACES)

SCENARIO = """\
schema_version: 1
name: whole
model: models/rov.xml
duration_s: 0.3
path: {type: csv, file: tables/points.csv}
guidance: {speed_m_s: 0.4}
initial: {position_m: [0, 0, -5]}
knowledge: {model: models/drawn/drawn.xml}
control: {law: {python: laws/pid.py:pid}}
checks:
  - {kind: allowed_forces}
"""


@pytest.fixture
def sources(tmp_path) -> Path:
    """A folder with a scenario that names files of every kind, and an MJCF made of several, not all UTF-8."""
    folder = tmp_path / "here"
    text = CUBE.read_text()
    assert text.count("<worldbody>") == text.count("<option ") == 1
    start = text.index("<option ")
    option = text[start : text.index("/>", start) + 2]
    parts = {
        "mission.yaml": SCENARIO,
        "tables/points.csv": "x_m,y_m,z_m\n0,0,-5\n3,1,-5\n6,0,-4\n",
        "models/drawn/drawn.xml": text,
        "laws/pid.py": PID,
        "models/option.xml": f"<mujocoinclude>{option}</mujocoinclude>",
        "models/wreck/meshes/block.obj": OBJ,
        "models/wreck/wreck.xml": '<mujoco model="wreck"><compiler meshdir="meshes"/><asset><mesh name="block"'
        ' file="block.obj"/></asset><worldbody><body name="block" pos="3 5 -9"><geom type="mesh" mesh="block"/>'
        "</body></worldbody></mujoco>",
        "models/rov.xml": text.replace(option, '<!-- caf\xe9 --><include file="option.xml"/>').replace(
            "<worldbody>",
            '<asset><model name="wreck" file="wreck/wreck.xml"/></asset><worldbody><attach model="wreck"'
            ' body="block" prefix="w_"/>',
        ),
    }
    for name, content in parts.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content.encode("latin-1"))
    return folder


@pytest.mark.flight
def test_what_is_recorded_flies_again_to_the_same_bytes(sources, tmp_path):
    first = cube_sim.run(sources / "mission.yaml", out=tmp_path / "out")
    shutil.rmtree(sources)
    moved = first.directory.rename(tmp_path / "moved")
    before = (moved / "run.mcap").read_bytes()
    assert str(tmp_path).encode() not in before

    recording = read_recording(moved / "run.mcap")
    assert set(recording.header.inputs) == {
        "model/rov.xml",
        "model/option.xml",
        "model/wreck/wreck.xml",
        "model/wreck/meshes/block.obj",
        "knowledge.model/drawn.xml",
        "path.file/points.csv",
    }
    assert b"caf\xe9" in recording.header.inputs["model/rov.xml"]
    (tmp_path / "elsewhere").mkdir()
    saved = load(save_inputs(recording.header, tmp_path / "elsewhere"))
    again = cube_sim.fly(replace(saved, text=recording.header.scenario), out=tmp_path / "again")
    assert (again.directory / "run.mcap").read_bytes() == before


def packed(channel: Channel, message: bytes) -> bytes:
    """A message of now as one without names."""
    row = channel_layout(channel).read(np.frombuffer(message, np.uint8)[None], channel.width)[0]
    layout = packed_layout(channel)
    data = layout.template.copy()
    for start, column, count in layout.spans:
        data[start : start + 8 * count] = row[column : column + count].view(np.uint8)
    return data.tobytes()


def as_earlier_versions_wrote(source: Path, target: Path) -> None:
    """The MJCF as model.xml, the files it refers to as assets/NAME, no other inputs; numbers without names, no end."""
    table = {f"/{channel.name}": channel for channel in read_recording(source).channels}
    reader = make_reader(source.open("rb"))
    summary = reader.get_summary()
    assert summary is not None
    with target.open("wb") as file:
        writer = Writer(file)
        writer.start()
        for each in reader.iter_attachments():
            name = {"model/cube.xml": "model.xml"}.get(each.name, each.name)
            writer.add_attachment(each.create_time, each.log_time, name, each.media_type, each.data)
        for each in reader.iter_metadata():
            if each.name == "end":
                continue
            kept = {key: value for key, value in each.metadata.items() if key != "model"}
            writer.add_metadata(each.name, {**kept, "format": "1"} if "format" in kept else kept)
        ids = {}
        for channel in summary.channels.values():
            schema = summary.schemas[channel.schema_id]
            of = writer.register_schema(schema.name, schema.encoding, schema.data)
            ids[channel.id] = writer.register_channel(channel.topic, "protobuf", of, channel.metadata)
        for _, channel, message in reader.iter_messages():
            data = packed(table[channel.topic], message.data) if channel.topic in table else message.data
            writer.add_message(ids[channel.id], message.log_time, data, message.publish_time, message.sequence)
        writer.finish()


@pytest.mark.flight
def test_a_record_of_an_earlier_version_is_read(tmp_path):
    path = scenario_with(tmp_path, "")
    now = cube_sim.run(path, out=tmp_path / "out").directory / "run.mcap"
    old = tmp_path / "old.mcap"
    as_earlier_versions_wrote(now, old)
    found, expected = read_recording(old), read_recording(now)
    assert found.header.mjcf == expected.header.mjcf == CUBE.read_text()
    assert found.header.resolved == expected.header.resolved
    for name, rows in expected.rows.items():
        assert found.rows[name].tobytes() == rows.tobytes()
    assert (found.complete, found.flaw) == (False, CANNOT_KNOW)
    assert found.end is None
    with pytest.raises(RecordingError, match=r"old\.mcap: is a record of format 1: it lacks files"):
        replay(cube_sim.load_run(old))
    rrd_from_mcap(old, tmp_path / "old.rrd")
    assert (tmp_path / "old.rrd").stat().st_size > 10_000


@pytest.mark.flight
def test_the_view_is_made_again_from_the_record_alone(sources, tmp_path):
    first = cube_sim.run(sources / "mission.yaml", out=tmp_path / "out")
    shutil.rmtree(sources)
    rrd_from_mcap(first.directory / "run.mcap", tmp_path / "again.rrd")
    assert (tmp_path / "again.rrd").stat().st_size > 10_000


@pytest.mark.flight
def test_a_table_and_a_shared_part_are_found_in_the_record_alone(sources, tmp_path, monkeypatch, capsys):
    rov = (sources / "models" / "rov.xml").read_bytes()
    (sources / "models" / "drawn" / "drawn.xml").write_bytes(rov.replace(b'file="wreck', b'file="../wreck'))
    shutil.copy(sources / "models" / "option.xml", sources / "models" / "drawn")
    run = cube_sim.run(sources / "mission.yaml", out=tmp_path / "out").directory
    shutil.rmtree(sources)
    (tmp_path / "checks.yaml").write_text("checks:\n  - {kind: allowed_forces}\n")

    assert cube_sim.load_run(run).scenario.path.type == "csv"
    for command in (
        ("replay", run),
        ("judge", run),
        ("judge", run, "--checks", tmp_path / "checks.yaml"),
        ("report", run, "--out", tmp_path / "page.html"),
        ("export", run, tmp_path / "view", "--format", "rrd"),
    ):
        code, _, said = call(monkeypatch, capsys, *command)
        assert code == 0, (command, said)
