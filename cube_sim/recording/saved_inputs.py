"""The inputs of a recorded run as files again, which can be run."""

from __future__ import annotations

from pathlib import Path, PurePosixPath

from cube_sim.errors import RecordingError
from cube_sim.recording.header import RunHeader
from cube_sim.recording.mcap.names import CODE, RESOLVED


def save_inputs(header: RunHeader, folder: Path) -> Path:
    """Write everything a run needs into a folder, under the names the record has for it.

    Args:
        header: of the recording.
        folder: exists.

    Returns:
        The scenario in it, every default written out.

    Raises:
        RecordingError: a file of the recording would lie outside the folder.
        OSError: a file cannot be written.
    """
    files = {RESOLVED: header.resolved.encode(), **header.inputs}
    files |= {CODE + code.file: code.source.encode() for code in header.code if code.source}
    for name, content in files.items():
        place = PurePosixPath(name)
        if place.is_absolute() or ".." in place.parts:
            raise RecordingError(f"a recording does not hold files outside its own folder: {name!r}")
        file = folder / place
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(content)
    return folder / RESOLVED
