from __future__ import annotations

import io
import json
import os
import signal
import struct
import subprocess
import sys
from contextlib import suppress
from dataclasses import asdict
from hashlib import sha256
from pathlib import Path

import mcap.reader
import mcap.writer
import numpy as np
import pytest
from google.protobuf import descriptor_pb2, descriptor_pool, message_factory
from mcap.opcode import Opcode
from mcap.records import Channel as DeclaredChannel
from mcap.records import Chunk, Message, MessageIndex
from mcap.stream_reader import StreamReader, breakup_chunk, get_chunk_data_stream
from support.helix_run import DT, END, HEADER, THRUSTERS, append_tick, fly, model, table

from cube_sim.errors import RecordingError
from cube_sim.recording.channels import Channel, Field
from cube_sim.recording.mcap.named_fields import parts_of
from cube_sim.recording.mcap.names import EPOCH_NS
from cube_sim.recording.reading import read_recording, read_signals
from cube_sim.recording.recorder import Recorder
from cube_sim.recording.run_end import RunEnd

TICKS = 160  # more than three simulated seconds, the last one begun and not full
FOR_VIEWERS = ("/scene", "/tf/target")
DRAWN = 1 + 1 + 1 + 32 + 7  # hull, path, trail, arrows ten times a second, places of the target twice a second


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, dict[str, np.ndarray]]:
    directory = tmp_path_factory.mktemp("run")
    with Recorder(directory, HEADER, table(), model()) as recorder:
        fly(recorder, TICKS)
        recorder.finish(END)
    return recorder.mcap, recorder.signals


def messages(path: Path, topic: str) -> list:
    """Decode the messages of a topic with the public MCAP reader and protobuf alone."""
    with path.open("rb") as file:
        reader = mcap.reader.make_reader(file, validate_crcs=True)
        found = []
        for schema, _, message in reader.iter_messages(topics=[topic]):
            pool = descriptor_pool.DescriptorPool()
            for declared in descriptor_pb2.FileDescriptorSet.FromString(schema.data).file:
                pool.Add(declared)
            kind = message_factory.GetMessageClass(pool.FindMessageTypeByName(schema.name))
            found.append((message, kind.FromString(message.data)))
        return found


def test_signals_come_back_bit_for_bit(run):
    path, signals = run
    back = read_signals(path)
    assert list(back) == list(signals)
    for name, values in signals.items():
        assert back[name].tobytes() == values.tobytes(), name
        assert back[name].shape == values.shape, name


def test_signals_hold_what_was_appended(run):
    _, signals = run
    t = np.arange(TICKS) * DT
    assert np.array_equal(signals["pose.position"][:, 0], t)
    force = 20 * np.sin(0.4 * t[:, None] + np.arange(8))
    np.testing.assert_allclose(signals["thrusters.force_demanded"][:, 1:], force, rtol=1e-14)
    assert signals["path.points"].shape[0] == 1
    assert signals["target.arc_length"].shape == (TICKS, 2)


def test_signals_are_complete_before_the_end_and_reading_them_changes_nothing(tmp_path):
    files = []
    for look in (False, True):
        directory = tmp_path / str(look)
        directory.mkdir()
        with Recorder(directory, HEADER, table(), model()) as recorder:
            for k in range(70):
                append_tick(recorder, k)
                if look and k % 7 == 0:
                    assert len(recorder.signals["pose.position"]) == k + 1
        files.append(recorder.mcap.read_bytes())
    assert files[0] == files[1]


def test_the_same_run_gives_the_same_bytes(run, tmp_path):
    with Recorder(tmp_path, HEADER, table(), model()) as recorder:
        fly(recorder, TICKS)
        recorder.finish(END)
    assert recorder.mcap.read_bytes() == run[0].read_bytes()


def test_any_protobuf_reader_decodes_a_channel(run):
    path, signals = run
    decoded = messages(path, "/wrench")
    assert len(decoded) == TICKS
    for k, (message, row) in enumerate(decoded):
        assert message.log_time == EPOCH_NS + round(k * DT * 1e9)
        assert message.sequence == k
        assert row.t == k * DT
        for field in ("demanded", "allocated", "disturbance"):
            group = getattr(row, field)
            named = [getattr(group, name) for name in ("Fx_N", "Fy_N", "Fz_N", "Mx_N_m", "My_N_m", "Mz_N_m")]
            assert named == list(signals[f"wrench.{field}"][k, 1:])
    (_, row), *_ = messages(path, "/allocation")
    assert row.cost_N2 == signals["allocation.cost"][0, 1]
    assert signals["allocation.subset"][0, 3] == row.subset.T3
    (_, row), *_ = messages(path, "/path")
    assert (row.points[7].x_m, row.points[7].z_m) == tuple(signals["path.points"][0, [22, 24]])
    (_, row), *_ = messages(path, "/actuation")
    assert row.limits.T2.F_max_plus_N == signals["actuation.limits"][0, 8] == 50.0
    assert row.matrix.Mz.T8_N_m_N == signals["actuation.matrix"][0, 48]


def test_codes_are_enums_with_their_labels(run):
    path, signals = run
    decoded = messages(path, "/allocation")
    status = decoded[0][1].DESCRIPTOR.fields_by_name["status"].enum_type
    assert [(value.number, value.name) for value in status.values] == [(0, "exact"), (1, "nearest")]
    assert [row.status for _, row in decoded] == signals["allocation.status"][:, 1].tolist()
    assert {row.status for _, row in decoded} == {0, 1}


@pytest.mark.parametrize("code", [0.5, -1.0, 128.0, float("nan")])
def test_a_code_that_is_none_is_refused(tmp_path, code):
    with Recorder(tmp_path, HEADER, table(), model(), view=False) as recorder:
        recorder.append("allocation", 0.0, 0.0, 0.0, code, np.zeros(8))
        with pytest.raises(RecordingError, match="a code is a whole number from 0 to 127"):
            recorder.append("allocation", 1.0, 0.0, 0.0, 0.0, np.zeros(8))


def test_names_that_protobuf_does_not_allow_are_told_apart():
    odd = Field("speed", 4, "m/s", "of some", ("hélice 1", "hélice-1", "2nd", "T+"))
    (group,) = parts_of(Channel("c", (odd,)))
    assert [number.name for number in group.elements[0]] == [
        "h_lice_1_m_s",
        "h_lice_1_m_s_2",
        "n2nd_m_s",
        "T_plus_m_s",
    ]


def test_rows_are_canonical_protobuf_but_for_zeros(run):
    for message, row in messages(run[0], "/wrench")[1:]:
        assert row.SerializeToString() == message.data


def test_the_vehicle_is_a_foxglove_frame_transform(run):
    path, signals = run
    decoded = messages(path, "/tf")
    assert len(decoded) == TICKS
    for k, (message, row) in enumerate(decoded):
        assert row.timestamp.ToNanoseconds() == message.log_time
        assert (row.parent_frame_id, row.child_frame_id) == ("world", "octa")
        position = [row.translation.x, row.translation.y, row.translation.z]
        quaternion = [row.rotation.w, row.rotation.x, row.rotation.y, row.rotation.z]
        assert position == list(signals["pose.position"][k, 1:])
        assert quaternion == list(signals["pose.quaternion"][k, 1:])


def test_the_log_is_foxglove_log_and_comes_back(run):
    decoded = messages(run[0], "/log")
    assert [(row.level, row.message, row.name) for _, row in decoded] == [
        (2, "tick 25: vehicle under way, 20 °C", "octa"),
        (2, "tick 125: vehicle under way, 20 °C", "octa"),
    ]
    log = read_recording(run[0]).log
    assert [(line.t, line.level, line.text) for line in log] == [
        (25 * DT, "INFO", decoded[0][1].message),
        (125 * DT, "INFO", decoded[1][1].message),
    ]


def test_the_header_comes_first_and_comes_back(run):
    recording = read_recording(run[0])
    assert recording.header == HEADER
    assert recording.channels == table()
    assert recording.complete
    kinds = [type(record).__name__ for record in StreamReader(io.BytesIO(run[0].read_bytes())).records]
    first_row, last_row = kinds.index("Message"), len(kinds) - kinds[::-1].index("Message")
    assert not {"Attachment", "Metadata"} & set(kinds[first_row:last_row])
    assert kinds[last_row:].count("Metadata") == 1


def test_every_summary_number_is_that_of_the_messages(run):
    with run[0].open("rb") as file:
        summary = mcap.reader.make_reader(file).get_summary()
    records = list(StreamReader(io.BytesIO(run[0].read_bytes()), validate_crcs=True).records)
    found = [record for record in records if isinstance(record, Message)]
    statistics = summary.statistics
    assert statistics.message_count == len(found) == TICKS * 11 + 2 + 2 + DRAWN
    assert statistics.message_start_time == min(message.log_time for message in found)
    assert statistics.message_end_time == max(message.log_time for message in found)
    assert statistics.chunk_count == len(summary.chunk_indexes) == 4
    for channel_id, count in statistics.channel_message_counts.items():
        assert count == sum(message.channel_id == channel_id for message in found)


def test_messages_stand_in_the_order_of_time_from_the_first_to_the_last(run):
    """What `mcap doctor --strict-message-order` asks for; those of one instant in the order of the channels."""
    records = StreamReader(io.BytesIO(run[0].read_bytes())).records
    stamps = [(record.log_time, record.channel_id) for record in records if isinstance(record, Message)]
    assert stamps == sorted(stamps)


@pytest.mark.parametrize("order", ["channel after channel", "backwards within an instant", "one chunk"])
def test_a_file_sorted_by_others_is_read_the_same(run, tmp_path, order):
    whole = run[0].read_bytes()
    found = list(mcap.reader.make_reader(io.BytesIO(whole)).iter_messages())
    summary = mcap.reader.make_reader(io.BytesIO(whole)).get_summary()
    attachments = list(mcap.reader.make_reader(io.BytesIO(whole)).iter_attachments())
    metadata = list(mcap.reader.make_reader(io.BytesIO(whole)).iter_metadata())
    if order == "channel after channel":  # as earlier versions wrote each second
        found.sort(key=lambda each: (each[2].log_time // 10**9, each[1].id))
    elif order == "backwards within an instant":
        found.sort(key=lambda each: (each[2].log_time, -each[1].id))
    path = tmp_path / "sorted.mcap"
    with path.open("wb") as file:
        writer = mcap.writer.Writer(file, chunk_size=10**9 if order == "one chunk" else 50_000)
        writer.start()
        for each in attachments:
            writer.add_attachment(each.create_time, each.log_time, each.name, each.media_type, each.data)
        for each in metadata:
            writer.add_metadata(each.name, each.metadata)
        ids = {}
        for channel in summary.channels.values():
            schema = summary.schemas[channel.schema_id]
            of = writer.register_schema(schema.name, schema.encoding, schema.data)
            ids[channel.id] = writer.register_channel(channel.topic, "protobuf", of, channel.metadata)
        for _, channel, message in found:
            writer.add_message(ids[channel.id], message.log_time, message.data, message.publish_time, message.sequence)
        writer.finish()
    back, kept = read_recording(path), read_recording(run[0])
    assert (back.header, back.log, back.channels, back.complete) == (kept.header, kept.log, kept.channels, True)
    for name, rows in kept.rows.items():
        assert back.rows[name].tobytes() == rows.tobytes(), name


def test_the_index_leads_to_the_messages_of_a_time_window(run):
    start, end = EPOCH_NS + 1_500_000_000, EPOCH_NS + 2_100_000_000
    with run[0].open("rb") as file:
        window = mcap.reader.make_reader(file).iter_messages("/pose", starting_at=start, ending_before=end)
        found = [message.log_time for _, _, message in window]
    assert found == [EPOCH_NS + k * 20_000_000 for k in range(75, 105)]


def test_the_message_index_points_at_every_message(run):
    data = run[0].read_bytes()
    records = StreamReader(io.BytesIO(data), emit_chunks=True).records
    chunk, indexed, messages_in_chunks = b"", 0, 0
    for record in records:
        if isinstance(record, Chunk):
            chunk = get_chunk_data_stream(record)[0].read(record.uncompressed_size)
            messages_in_chunks += sum(isinstance(part, Message) for part in breakup_chunk(record))
        if isinstance(record, MessageIndex):
            for log_time, offset in record.records:
                assert chunk[offset] == Opcode.MESSAGE
                channel_id, _, stamp = struct.unpack_from("<HIQ", chunk, offset + 9)
                assert (channel_id, stamp) == (record.channel_id, log_time)
                indexed += 1
    assert indexed == messages_in_chunks == TICKS * 11 + 2 + 2 + DRAWN


def test_a_second_is_in_the_file_as_soon_as_it_is_over(tmp_path):
    # So few numbers that several seconds would fit into the buffer of an open file.
    depth = Channel("depth", (Field("depth", 1, "m", "below the surface"),))
    recorder = Recorder(tmp_path, HEADER, (depth,), model(), view=False)
    for k in range(501):
        recorder.append("depth", k * DT, 0.5)
        if k and k % 50 == 0:
            kept = read_signals(recorder.mcap)["depth.depth"]
            assert np.array_equal(kept[:, 0], np.arange(k) * DT)
    recorder.close()


@pytest.mark.flight
def test_a_killed_run_loses_less_than_a_simulated_second(tmp_path):
    reached = 130
    program = (
        "import os, signal, sys\n"
        "from pathlib import Path\n"
        "from support.helix_run import *\n"
        "recorder = Recorder(Path(sys.argv[1]), HEADER, table(), model())\n"
        f"fly(recorder, {reached})\n"
        "os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[1])}
    ended = subprocess.run([sys.executable, "-c", program, str(tmp_path)], env=environment, timeout=60)
    assert ended.returncode == -signal.SIGKILL
    path = tmp_path / "run.mcap"

    recording = read_recording(path)
    assert not recording.complete
    assert recording.header == HEADER
    kept = recording.signals["pose.position"]
    assert kept[-1, 0] >= (reached - 1) * DT - 1.0
    with Recorder(tmp_path, HEADER, table(), model()) as recorder:
        fly(recorder, reached)
    assert np.array_equal(kept, recorder.signals["pose.position"][: len(kept)])


def test_the_public_stream_reader_reads_what_a_kill_left(run, tmp_path):
    whole = run[0].read_bytes()
    recording = read_recording(run[0])
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(whole[: int(0.6 * len(whole))])
    kept = []
    reader = StreamReader(io.BytesIO(cut.read_bytes())).records
    with pytest.raises(Exception):  # noqa: B017 - the reader's way of saying that the file ends
        kept.extend(reader)
    drawn = {each.id for each in kept if isinstance(each, DeclaredChannel) and each.topic.startswith(FOR_VIEWERS)}
    public = sum(isinstance(record, Message) and record.channel_id not in drawn for record in kept)
    ours = read_recording(cut)
    rows = sum(len(channel) for channel in ours.rows.values())
    assert rows + len(ours.rows["pose"]) + len(ours.log) == public > 0
    for name, values in ours.rows.items():
        assert np.array_equal(values, recording.rows[name][: len(values)])


@pytest.mark.parametrize("fraction", np.linspace(0.0, 0.999, 25))
def test_a_file_cut_anywhere_is_read_as_far_as_it_goes_or_refused(run, tmp_path, fraction):
    whole = run[0].read_bytes()
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(whole[: int(fraction * len(whole))])
    try:
        recording = read_recording(cut)
    except RecordingError:
        # Only without its header is a recording none at all.
        assert fraction < 0.5
        return
    # Behind how the run ended there is nothing but the index.
    assert recording.complete == (recording.end is not None)
    if recording.complete:
        assert fraction > 0.8
        assert recording.rows["pose"].tobytes() == read_recording(run[0]).rows["pose"].tobytes()


def test_a_flipped_bit_in_the_head_is_a_damaged_record_or_none_that_is_whole(run, tmp_path):
    whole, damaged = run[0].read_bytes(), tmp_path / "damaged.mcap"
    for place in range(400):
        data = bytearray(whole)
        data[place] ^= 0x80 if place % 2 else 0x04
        damaged.write_bytes(data)
        with suppress(RecordingError):
            assert not read_recording(damaged).complete, place


@pytest.mark.parametrize("fraction", np.linspace(0.02, 0.9, 12))
def test_a_flipped_bit_is_noticed(run, tmp_path, fraction):
    data = bytearray(run[0].read_bytes())
    data[int(fraction * len(data))] ^= 0x10
    damaged = tmp_path / "damaged.mcap"
    damaged.write_bytes(data)
    try:
        recording = read_recording(damaged)
    except RecordingError:
        return
    # A flipped length makes the rest of the file unreachable: then it must not pass for a whole one.
    assert not recording.complete


def test_a_file_of_another_writer_is_refused(tmp_path):
    path = tmp_path / "other.mcap"
    path.write_bytes(b"not an mcap")
    with pytest.raises(RecordingError, match="is not an MCAP file"):
        read_signals(path)
    with pytest.raises(RecordingError, match="cannot be read"):
        read_signals(tmp_path / "missing.mcap")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("posse", 0.0, np.zeros(3)), "no channel 'posse'; there are 13, the nearest pose"),
        (("pose", 0.0, np.zeros(3)), r"'pose' takes position\(3\), quaternion\(4\)"),
        (("pose", 0.0, np.zeros(3), np.zeros(3)), r"shapes \[\(3,\), \(3,\)\]"),
        (("pose", 0.0, 1.0, np.zeros(4)), r"shapes \[\(\), \(4,\)\]"),
        (("pose", 0.0, np.zeros((1, 3)), np.zeros(4)), r"shapes \[\(1, 3\), \(4,\)\]"),
        (("pose", float("nan"), np.zeros(3), np.zeros(4)), "time runs backwards"),
        (("pose", -1.0, np.zeros(3), np.zeros(4)), "time runs backwards: t = -1.0 s after t = 0.0 s"),
    ],
)
def test_a_row_that_does_not_fit_is_refused(tmp_path, arguments, message):
    with Recorder(tmp_path, HEADER, table(), model()) as recorder:
        recorder.log(0.0, "INFO", "start")
        with pytest.raises(RecordingError, match=message):
            recorder.append(*arguments)
    assert read_recording(recorder.mcap).rows == {}


def test_a_short_row_is_refused_in_the_middle_of_a_block(tmp_path):
    with Recorder(tmp_path, HEADER, table(), model()) as recorder:
        recorder.append("pose", 0.0, np.zeros(3), np.zeros(4))
        with pytest.raises(RecordingError, match="takes position"):
            recorder.append("pose", 0.02, np.zeros(3))
        with pytest.raises(RecordingError, match="takes position"):
            recorder.append("pose", 0.02, np.zeros(4), np.zeros(4))


def test_a_recorder_that_is_given_nothing_leaves_what_is_there(tmp_path):
    names = "run.mcap", "run.rrd"
    for name in names:
        (tmp_path / name).write_text("earlier")
    with Recorder(tmp_path, HEADER, table(), model()) as recorder:
        assert recorder.signals["pose.position"].shape == (0, 4)
    assert {each.name: each.read_text() for each in tmp_path.iterdir()} == dict.fromkeys(
        ("run.mcap", "run.rrd"), "earlier"
    )


def test_the_record_takes_its_place_with_its_first_second(tmp_path):
    (tmp_path / "run.mcap").write_text("earlier")
    seen = []
    begin = lambda: seen.append((tmp_path / "run.mcap").read_text())  # noqa: E731
    with Recorder(tmp_path, HEADER, table(), model(), view=False, begin=begin) as recorder:
        fly(recorder, 50)
        assert (seen, (tmp_path / "run.mcap").read_text()) == ([], "earlier")
        fly(recorder, 1, 50)
        assert seen == ["earlier"]
        assert len(read_signals(recorder.mcap)["pose.position"]) == 50
    assert [each.name for each in tmp_path.iterdir()] == ["run.mcap"]


def test_nothing_can_be_added_after_the_end(tmp_path):
    recorder = Recorder(tmp_path, HEADER, table(), model())
    recorder.log(0.0, "INFO", "start")
    recorder.close()
    recorder.close()
    with pytest.raises(RecordingError, match="closed"):
        recorder.log(1.0, "INFO", "end")
    with pytest.raises(RecordingError, match="no log level 'LOUD'; there are UNKNOWN, DEBUG"):
        recorder.log(1.0, "LOUD", "end")


def test_a_run_that_raises_leaves_a_whole_file(tmp_path):
    def interrupted() -> None:
        with Recorder(tmp_path, HEADER, table(), model()) as recorder:
            fly(recorder, 60)
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        interrupted()
    recording = read_recording(tmp_path / "run.mcap")
    assert not recording.complete
    assert recording.end is None
    assert len(recording.rows["pose"]) == 60
    with (tmp_path / "run.mcap").open("rb") as file:
        assert mcap.reader.make_reader(file).get_summary() is not None


def test_a_fast_channel_outgrows_its_buffer(tmp_path):
    fast = Channel("imu", (Field("acceleration", 3, "m/s^2", "specific force, body axes"),), 1000.0)
    with Recorder(tmp_path, HEADER, (fast,), model()) as recorder:
        for k in range(1500):
            recorder.append("imu", k * 1e-3, np.array([k, -k, 0.5 * k]))
    values = read_signals(recorder.mcap)["imu.acceleration"]
    assert np.array_equal(values, np.arange(1500)[:, None] * np.array([1e-3, 1.0, -1.0, 0.5]))


def test_channels_declare_themselves_in_the_file(run):
    declared = {channel.name: channel for channel in read_recording(run[0]).channels}
    force = declared["thrusters"].fields[2]
    assert (force.name, force.unit, force.columns) == ("force", "N", THRUSTERS)
    assert declared["allocation"].fields[2].labels == ("exact", "nearest")
    for channel in declared.values():
        for field in channel.fields:
            assert field.unit
            assert field.doc


@pytest.mark.parametrize(("width", "columns"), [(0, ()), (3, ("x", "y"))])
def test_a_field_that_contradicts_itself_is_refused(width, columns):
    with pytest.raises(ValueError, match="width"):
        Field("position", width, "m", "somewhere", columns)


def test_the_record_says_how_its_run_ended(run):
    assert read_recording(run[0]).end == END
    with run[0].open("rb") as file:
        tables = {each.name: each.metadata for each in mcap.reader.make_reader(file).iter_metadata()}
    assert json.loads(tables["end"]["how"]) == "completed"
    digests = json.loads(tables["end"]["digests"])
    wrench = next(channel for channel in table() if channel.name == "wrench")
    rows = np.hstack([run[1][f"wrench.{name}"][:, 1:] for name in ("demanded", "allocated", "disturbance")])
    rows = np.hstack([run[1]["wrench.demanded"][:, :1], rows])
    text = json.dumps(asdict(wrench), sort_keys=True)
    assert digests["channels"]["wrench"] == {
        "rows": TICKS,
        "sha256": sha256(text.encode() + rows.astype("<f8").tobytes()).hexdigest(),
    }


@pytest.mark.parametrize("how", ["interrupted", "failed", "recovered"])
def test_a_flight_that_was_stopped_is_not_complete(tmp_path, how):
    with Recorder(tmp_path, HEADER, table(), model(), view=False) as recorder:
        fly(recorder, 60)
        recorder.finish(RunEnd(how, "because", 60, 1.2))
    recording = read_recording(recorder.mcap)
    when = "" if how == "recovered" else " at 1.2 s"
    assert (recording.complete, recording.flaw) == (False, f"{how}{when}: because")
    assert recording.end == RunEnd(how, "because", 60, 1.2)
