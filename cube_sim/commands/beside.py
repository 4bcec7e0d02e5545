"""Where a command writes about a run, when nobody says where."""

from __future__ import annotations

from pathlib import Path

from cube_sim.run_directory import MCAP_FILE, RESOLVED_FILE


def beside(run: Path, suffix: str, more: str = "") -> Path:
    """A file named after a run, beside its folder: in there is nothing but what the run writes.

    Args:
        run: its folder or its record.
        suffix: of the file, with its dot.
        more: what else its name says.
    """
    first = run.resolve() if run.name in ("", "..") else run
    if first.name == MCAP_FILE and first.with_name(RESOLVED_FILE).is_file():
        first = first.absolute().parent
    name = first.name if first.is_dir() else first.stem
    return first.with_name(f"{name}{more}{suffix}")
