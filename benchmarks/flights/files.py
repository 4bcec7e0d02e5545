"""Files of a mission, that several processes may write at once: the same text, whole or not there."""

from __future__ import annotations

import os
from pathlib import Path


def put(file: Path, text: str) -> Path:
    """Write a text, unless it stands there; the file."""
    if not (file.is_file() and file.read_text() == text):
        file.parent.mkdir(parents=True, exist_ok=True)
        part = file.with_name(f".{os.getpid()}.{file.name}")
        part.write_text(text)
        part.replace(file)
    return file
