"""``cube-sim schema``: what editors check scenario files by."""

from __future__ import annotations

import typer


def schema() -> None:
    """Print the JSON schema of scenario files, for editors."""
    from cube_sim.scenario.json_schema import json_schema

    typer.echo(json_schema(), nl=False)
