"""The option ``--set PATH=VALUE``: values that take the place of a scenario's."""

from __future__ import annotations

from typing import Annotated, Any

import typer

from cube_sim.errors import ScenarioError

Settings = Annotated[
    list[str] | None,
    typer.Option(
        "--set",
        metavar="PATH=VALUE",
        help="Replace a value of the scenario, for example --set guidance.speed_m_s=0.3 or "
        "--set checks.0.at_most=0.2; VALUE is YAML. May be repeated.",
    ),
]


def overrides(settings: list[str] | None) -> dict[str, Any]:
    """Turn ``PATH=VALUE`` arguments into overrides: dotted path -> plain data.

    Raises:
        ScenarioError: one mistake per argument that is not a path and a YAML value.
    """
    from cube_sim.scenario.document import parse_value

    found: dict[str, Any] = {}
    mistakes: list[str] = []
    for setting in settings or []:
        path, equals, text = setting.partition("=")
        path = path.strip()
        if not equals or not path:
            mistakes.append(f"--set {setting}: write PATH=VALUE, for example duration_s=60")
        elif path in found:
            mistakes.append(f"--set {setting}: {path} is set twice")
        else:
            try:
                found[path] = parse_value(text)
            except ValueError as error:
                mistakes.append(f"--set {setting}: {error}")
    if mistakes:
        raise ScenarioError(mistakes)
    return found
