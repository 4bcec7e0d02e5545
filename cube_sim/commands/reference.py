"""``cube-sim reference``: what a scenario may say and what a run records, as pages to read."""

from __future__ import annotations

from enum import StrEnum
from typing import Annotated

import typer


class Page(StrEnum):
    """A page of the reference."""

    SCENARIO = "scenario"
    RECORDING = "recording"


def reference(
    page: Annotated[Page, typer.Argument(help="scenario: every key of a file; recording: every channel and field.")],
) -> None:
    """Print the reference of scenario files or of recordings, as Markdown."""
    match page:
        case Page.SCENARIO:
            from cube_sim.commands.pages.scenario_page import scenario_page as text
        case Page.RECORDING:
            from cube_sim.commands.pages.recording_page import recording_page as text
    typer.echo(text(), nl=False)
