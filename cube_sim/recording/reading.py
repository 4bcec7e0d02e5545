"""Reading a recording back, bit for bit, also one whose writer was killed."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from cube_sim.errors import RecordingError
from cube_sim.recording.batch import Rows, signals
from cube_sim.recording.channels import Channel
from cube_sim.recording.digests import ChannelDigest, channel_digests, head_digests, others
from cube_sim.recording.header import RecordedCode, RunHeader
from cube_sim.recording.mcap.names import (
    ASSETS,
    CODE,
    CODE_METADATA,
    EARLIER,
    END_METADATA,
    FORMAT,
    FORMATS,
    MODEL,
    MODEL_NAME,
    RESOLVED,
    RUN_METADATA,
    SCENARIO,
    VEHICLES_METADATA,
    VERSIONS_METADATA,
)
from cube_sim.recording.mcap.reader import McapContents, chunks_of, read_contents
from cube_sim.recording.messages import RecordedMessages
from cube_sim.recording.run_end import RunEnd, from_texts
from cube_sim.run_log import LogLine

NO_END = "it does not say how the run ended"
ALTERED = "the record was altered"
CANNOT_KNOW = "its format says neither how the run ended nor whether anything was altered: it may be all, or not"
"""Of a record from before format 3 whose file has its end."""


@dataclass(frozen=True, eq=False, repr=False)
class Recording:
    """A run, read back; it equals itself alone.

    Attributes:
        header: the inputs of the run.
        vehicle: name of the vehicle's frame.
        channels: the channel table the run was recorded with.
        rows: all rows of each channel that has any, (n, 1+width), column 0 the time [s].
        log: the messages, in the order of time.
        end: how the run ended; None where the record does not say it, as after a crash and before format 3.
        flaw: why this is not all of what was recorded of a flight that came to its end, in words; "" if it is.
        counts: how many rows of each channel were recorded, as the end of the record says; empty where it does not.
        changed: what of that which is here is not as it was written, in words; "" where nothing is known to be.
    """

    header: RunHeader
    vehicle: str
    channels: tuple[Channel, ...]
    rows: Mapping[str, Rows]
    log: tuple[LogLine, ...]
    end: RunEnd | None = None
    flaw: str = ""
    counts: Mapping[str, int] = field(default_factory=dict)
    changed: str = ""

    def __repr__(self) -> str:
        """Vehicle, size and flaw, in one line."""
        rows = sum(map(len, self.rows.values()))
        return f"<Recording of {self.vehicle}: {len(self.channels)} channels, {rows} rows, {self.flaw or 'complete'}>"

    @property
    def signals(self) -> dict[str, Rows]:
        """Every field as "channel.field" -> (n, 1+width), column 0 the time [s]."""
        return signals(self.channels, self.rows)

    @property
    def complete(self) -> bool:
        """Whether the record says that the flight came to its end, and all that was recorded of it is here unchanged.

        Before format 3 no record says that.
        """
        return not self.flaw


def read_signals(path: str | Path) -> dict[str, Rows]:
    """Read the signals of a recording.

    Args:
        path: the MCAP file.

    Returns:
        "channel.field" -> (n, 1+width), column 0 the time [s]; the same bits the run had in memory.

    Raises:
        RecordingError: the file is not a recording, or it is damaged.
    """
    return read_recording(path).signals


def read_recording(path: str | Path) -> Recording:
    """Read a whole recording, also one that another program has sorted, merged or compressed anew.

    Args:
        path: the MCAP file.

    Raises:
        RecordingError: the file is not a recording, it is damaged, or it holds two runs. A file that merely ends early
            is read as far as it goes and has a flaw.
    """
    path = Path(path)
    contents = read_contents(path)
    header, vehicle = read_header(contents)
    messages = RecordedMessages(path, contents.metadata[RUN_METADATA]["format"])
    for chunk in contents.chunks():
        messages.take(chunk)
    read = Recording(
        header=header,
        vehicle=vehicle,
        channels=tuple(messages.channels.values()),
        rows={name: rows for name, rows in messages.rows().items() if len(rows)},
        log=messages.lines(),
    )
    return read_end(contents, read)


def read_channels(
    path: Path, names: Collection[str], chunks_at_once: int | None = None, format_: str = FORMAT
) -> Iterator[dict[str, Rows]]:
    """The rows of some channels; little more than these is ever in memory.

    Args:
        path: the MCAP file, without messages outside chunks.
        names: of the channels.
        chunks_at_once: of so many chunks rows are handed on together; None for all.
        format_: of the recording.

    Yields:
        Channel -> (n, 1+width), column 0 the time [s], of those that have been declared so far.

    Raises:
        RecordingError: the file cannot be read, or it is damaged.
    """
    messages = RecordedMessages(path, format_, names)
    for number, chunk in enumerate(chunks_of(path)):
        if chunks_at_once is not None and number and number % chunks_at_once == 0:
            yield messages.rows()
        messages.take(chunk)
    yield messages.rows()


def read_header(contents: McapContents) -> tuple[RunHeader, str]:
    """The inputs of the run, and the name of the vehicle's frame.

    Raises:
        RecordingError: they are not there, not readable, or those of two runs.
    """
    path = contents.path
    if contents.twice:
        raise RecordingError(f"{path} holds two runs: there are two {contents.twice[0]!r} in it")
    try:
        run, files = contents.metadata[RUN_METADATA], contents.attachments
        if run["format"] not in FORMATS:
            known = f"this version reads {', '.join(FORMATS)}"
            raise RecordingError(f"{path} is a recording of format {run['format']!r}; {known}")
        code = _code(contents)
        header = RunHeader(
            scenario=files[SCENARIO].decode(),
            resolved=files[RESOLVED].decode(),
            model=run.get(MODEL_NAME, MODEL),
            inputs={name.removeprefix(ASSETS): data for name, data in files.items() if _is_input(name, code)},
            code=code,
            versions=contents.metadata[VERSIONS_METADATA],
            seed=int(run["seed"]),
            vehicles=dict(contents.metadata.get(VEHICLES_METADATA, {})),
        )
        return header, run["vehicle"]
    except KeyError as missing:
        raise RecordingError(f"{path} is no recording of cube_sim: it has no {missing}") from None
    except ValueError as error:
        raise RecordingError(f"{path} is damaged: its inputs cannot be read") from error


def read_end(contents: McapContents, read: Recording, found: Mapping[str, ChannelDigest] | None = None) -> Recording:
    """A recording with how its run ended, and with its flaw if it has one.

    Args:
        contents: of its file.
        read: the recording.
        found: digests of its channels; None: they are made of its rows.
    """
    texts = contents.metadata.get(END_METADATA)
    if texts is None:
        whole = contents.complete and contents.metadata[RUN_METADATA]["format"] in EARLIER
        return replace(read, flaw=CANNOT_KNOW if whole else NO_END)
    try:
        end, digests = from_texts(texts)
        counts = {name: int(told["rows"]) for name, told in digests["channels"].items()}
        head = head_digests(contents.metadata, contents.attachments)
        found = channel_digests(read.channels, read.rows) if found is None else found
        different = list(others(digests, found, read.log, head))
    except (RecordingError, ValueError, TypeError, KeyError) as error:
        said = str(error) if isinstance(error, RecordingError) else "how the run ended cannot be read"
        return replace(read, flaw=said)
    changed = next((f"{ALTERED}: {other.text}" for other in different if not other.lost), "")
    flaw = f"{ALTERED}: {different[0].text}" if different else ""
    if not different and not end.of_itself:
        when = "" if end.simulated_s is None or end.how == "recovered" else f" at {end.simulated_s:g} s"
        flaw = f"{end.how}{when}{f': {end.reason}' if end.reason else ''}"
    return replace(read, end=end, flaw=flaw, counts=counts, changed=changed)


def _is_input(name: str, code: Sequence[RecordedCode]) -> bool:
    return name not in (SCENARIO, RESOLVED, *(CODE + each.file for each in code))


def _code(contents: McapContents) -> tuple[RecordedCode, ...]:
    """Code of the user's own that took part, by the values in whose place it stood."""
    named = [RecordedCode(key, name, "") for key, name in sorted(contents.metadata.get(CODE_METADATA, {}).items())]
    sources = [contents.attachments.get(CODE + code.file, b"").decode() for code in named]
    return tuple(replace(code, source=source) for code, source in zip(named, sources, strict=True))
