"""Files that other programs have written anew, and damaged ones: read rightly, or refused, or never called complete."""

from __future__ import annotations

import io
from pathlib import Path
from random import Random

import pytest
from mcap.data_stream import RecordBuilder
from mcap.reader import make_reader
from mcap.records import Channel
from support.helix_run import END, HEADER, fly, model, table
from support.laundering import COMPRESSED, with_fresh_checksums, written_anew

from cube_sim.errors import RecordingError
from cube_sim.recording.mcap.names import CHANNEL_METADATA
from cube_sim.recording.reading import Recording, read_recording
from cube_sim.recording.recorder import Recorder
from cube_sim.recording.run_end import RunEnd
from cube_sim.recording.salvage import salvage

TICKS = 110


def recorded(folder: Path, first: int = 0, seed: int = HEADER.seed) -> Path:
    header = HEADER.__class__(**{**vars(HEADER), "seed": seed})
    with Recorder(folder, header, table(), model(), view=False) as recorder:
        fly(recorder, TICKS, first)
        recorder.finish(END if first == 0 else RunEnd("completed"))
    return recorder.mcap


@pytest.fixture(scope="module")
def run(tmp_path_factory) -> Path:
    return recorded(tmp_path_factory.mktemp("run"))


@pytest.fixture(scope="module")
def other(tmp_path_factory) -> Path:
    return recorded(tmp_path_factory.mktemp("other"), seed=8)


def same(one: Recording, other: Recording) -> bool:
    rows = {name: table.tobytes() for name, table in one.rows.items()}
    return (one.header, one.channels, one.log, one.end, rows) == (
        other.header,
        other.channels,
        other.log,
        other.end,
        {name: table.tobytes() for name, table in other.rows.items()},
    )


@pytest.mark.parametrize("how", COMPRESSED)
def test_another_compression_changes_nothing(run, tmp_path, how):
    back = read_recording(written_anew(run, target=tmp_path / "new.mcap", **COMPRESSED[how]))
    assert same(back, read_recording(run))
    assert back.complete


ORDERS = {
    "backwards": lambda found: -found[2].log_time,
    "channel after channel": lambda found: (found[1].id, found[2].log_time),
    "shuffled": lambda found: hash((found[2].log_time * 7919, found[1].id)) % 1009,
}


@pytest.mark.parametrize("how", ORDERS)
@pytest.mark.parametrize("chunks", ["no chunks", "small chunks"])
def test_another_order_changes_nothing(run, tmp_path, how, chunks):
    back = read_recording(written_anew(run, target=tmp_path / "new.mcap", order=ORDERS[how], **COMPRESSED[chunks]))
    assert same(back, read_recording(run))
    assert back.complete


def test_sequence_numbers_may_be_lost(run, tmp_path):
    new = written_anew(run, target=tmp_path / "new.mcap", sequence=lambda _: 0, order=ORDERS["backwards"])
    assert same(read_recording(new), read_recording(run))


@pytest.mark.parametrize(
    ("keep", "told"),
    [
        (lambda found: found[1].topic != "/wrench", "it holds 0 of 110 rows of the channel 'wrench'"),
        (lambda found: found[2].sequence % 7, "it holds 0 of 1 rows of the channel 'actuation'"),
        (lambda found: found[1].topic != "/log", "the log is not the one recorded"),
    ],
)
def test_a_part_is_read_and_never_complete(run, tmp_path, keep, told):
    back = read_recording(written_anew(run, target=tmp_path / "new.mcap", keep=keep))
    assert not back.complete
    assert back.flaw == f"the record was altered: {told}"


@pytest.mark.parametrize("same_channels", [True, False])
def test_two_runs_in_one_file_are_refused(run, other, tmp_path, same_channels):
    for sources in ([run, other], [run, run]):
        new = written_anew(*sources, target=tmp_path / "new.mcap", same_channels=same_channels)
        with pytest.raises(RecordingError, match="holds two runs"):
            read_recording(new)
    with pytest.raises(RecordingError, match="holds two runs, or one twice: rows of 'pose' are there twice"):
        read_recording(
            written_anew(run, target=tmp_path / "new.mcap", twice=True, keep=lambda f: f[1].topic == "/pose")
        )


def test_what_is_left_of_a_record_is_what_was_recorded(run, tmp_path):
    whole, data = read_recording(run), bytearray(run.read_bytes())
    places = [k for k in range(len(data)) if data[k : k + 8] == b"\x04\0\0\0zstd"]
    data[places[1] - 2] ^= 1  # its checksum
    damaged = tmp_path / "damaged.mcap"
    damaged.write_bytes(data)
    with pytest.raises(RecordingError, match=r"the chunk from 1 s to 1\.98 s does not fit its checksum; `cube-sim rec"):
        read_recording(damaged)
    found = salvage(damaged)
    assert found.dropped == ("the chunk from 1 s to 1.98 s does not fit its checksum",)
    assert not found.recording.complete
    for name, rows in found.recording.rows.items():
        kept = whole.rows[name][(whole.rows[name][:, 0] < 1.0) | (whole.rows[name][:, 0] >= 2.0)]
        assert rows.tobytes() == kept.tobytes(), name
    damaged.write_bytes(run.read_bytes()[: places[2]])
    found = salvage(damaged)
    assert found.recording.rows["pose"][-1, 0] == 1.98
    damaged.write_bytes(run.read_bytes())
    assert salvage(damaged).dropped == ()
    assert same(salvage(damaged).recording, whole)


def test_a_channel_that_somebody_else_added_is_not_taken_for_recorded(run, tmp_path):
    """As one flipped bit of a name does, where the file names its channels twice."""
    data = run.read_bytes()
    end = data.index(b"\x03\0\0\0end") - 9  # where the metadata record starts
    reader = make_reader(io.BytesIO(data))
    (found,) = [each for each in reader.get_summary().channels.values() if each.topic == "/water"]
    text = {CHANNEL_METADATA: found.metadata[CHANNEL_METADATA].replace('"water"', '"wafer"')}
    record = RecordBuilder()
    Channel(900, "/wafer", "protobuf", text, found.schema_id).write(record)
    altered = tmp_path / "altered.mcap"
    rest = end + 9 + int.from_bytes(data[end + 1 : end + 9], "little")
    altered.write_bytes(data[:end] + data[end:rest])
    assert read_recording(altered).complete
    altered.write_bytes(data[:end] + record.end() + data[end:rest])
    for back in (read_recording(altered), salvage(altered).recording):
        assert (back.complete, back.flaw) == (
            False,
            "the record was altered: the channel 'wafer' is none of those recorded",
        )


def cases(run: Path, other: Path, folder: Path, seed: int) -> tuple[str, bytes]:
    """A damaged or laundered file, of a kind that depends on the seed."""
    random = Random(seed)
    data, new = run.read_bytes(), folder / "case.mcap"

    def flipped(inside: bytearray) -> None:
        for _ in range(random.choice((1, 1, 2, 8))):
            inside[random.randrange(len(inside))] ^= 1 << random.randrange(8)

    def cut(inside: bytearray) -> None:
        start = random.randrange(len(inside))
        del inside[start : start + random.choice((1, 9, 100, 10_000))]

    kind = random.choice(("flipped", "cut off", "cut out", "doubled", "fresh", "fresh", "fresh cut", "anew", "merged"))
    if kind == "flipped":
        damaged = bytearray(data)
        flipped(damaged)
    elif kind == "cut off":
        damaged = data[: random.randrange(len(data))]
    elif kind == "cut out":
        damaged = bytearray(data)
        cut(damaged)
    elif kind == "doubled":
        start, length = random.randrange(len(data)), random.choice((1, 100, 50_000))
        damaged = data[: start + length] + data[start:]
    elif kind.startswith("fresh"):
        damaged = with_fresh_checksums(data, cut if kind == "fresh cut" else flipped, random)
    elif kind == "anew":
        order = random.choice([None, *ORDERS.values()])
        lost = random.choice((2.0, 0.0, 0.001, 0.3))
        options = random.choice(list(COMPRESSED.values()))
        written_anew(run, target=new, order=order, keep=lambda _: random.random() >= lost or lost == 2.0, **options)
        damaged = bytearray(new.read_bytes())
        if random.random() < 0.5:
            flipped(damaged)
    else:
        written_anew(run, random.choice([run, other]), target=new, same_channels=random.random() < 0.5)
        damaged = new.read_bytes()
    return kind, bytes(damaged)


def judged(run: Path, other: Path, whole: Recording, folder: Path, seed: int) -> tuple[str, str]:
    """What became of a file: refused, incomplete, or complete; complete is right to the bit."""
    kind, data = cases(run, other, folder, seed)
    damaged = folder / "damaged.mcap"
    damaged.write_bytes(data)
    found = {}
    for how, read in (("saved", lambda path: salvage(path).recording), ("read", read_recording)):
        try:
            found[how] = read(damaged)
        except RecordingError as error:
            found[how] = str(error)
    for recording in found.values():
        if isinstance(recording, str):
            assert "\n" not in recording, (seed, kind)
        else:
            assert not recording.complete or same(recording, whole), (seed, kind)
    if isinstance(found["read"], str):
        return kind, "refused"
    return kind, "complete" if found["read"].complete else "not complete"


@pytest.mark.parametrize("seed", range(0, 300, 100))
def test_no_damaged_file_passes_for_a_whole_one(run, other, tmp_path, seed):
    whole = read_recording(run)
    for each in range(seed, seed + 100):
        judged(run, other, whole, tmp_path, each)


@pytest.mark.campaign
@pytest.mark.parametrize("seed", range(1000, 11_000, 1000))
def test_none_of_ten_thousand_damaged_files_passes_for_a_whole_one(run, other, tmp_path, capsys, seed):
    """A tenth of them each time."""
    whole, counts = read_recording(run), {}
    for each in range(seed, seed + 1000):
        became = judged(run, other, whole, tmp_path, each)
        counts[became] = counts.get(became, 0) + 1
    with capsys.disabled():
        print(f"\n{seed}:", ", ".join(f"{kind} {became} {count}" for (kind, became), count in sorted(counts.items())))
