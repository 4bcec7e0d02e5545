"""Pytest plugin: every YAML file in a folder called `scenarios` is a test that flies it.

Name it in the root conftest: ``pytest_plugins = ["cube_sim.testing"]``. A scenario file that cannot be read is a
failing test, not an error of the whole session. Each check's value, an early end and what the run's log says at the
level WARNING or above go into the test's user properties, and so into JUnit reports; a test that fails shows them.

The tests carry the marker ``flight``, which the plugin registers: ``pytest -m "not flight"`` leaves them out.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from cube_sim.errors import CubeSimError


class ScenarioFailedError(Exception):
    """A scenario did not pass; the text is what to show."""


def pytest_configure(config: pytest.Config) -> None:
    """Register the marker, so that --strict-markers knows it in any repository."""
    config.addinivalue_line("markers", "flight: flies a scenario from start to end, which takes seconds.")


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    """Collect scenario files."""
    if file_path.suffix == ".yaml" and file_path.parent.name == "scenarios":
        return ScenarioFile.from_parent(parent, path=file_path)
    return None


class ScenarioFile(pytest.File):
    """One scenario file."""

    def collect(self) -> Iterator[pytest.Item]:
        """One test, named after the file."""
        yield ScenarioItem.from_parent(self, name=self.path.stem)


class ScenarioItem(pytest.Item):
    """Flies one scenario and expects PASS."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self.add_marker("flight")

    def runtest(self) -> None:
        """Run the scenario, recording into pytest's temporary folder."""
        from cube_sim.commands.account import early_end, lasted, log_lines, section
        from cube_sim.commands.result_table import as_text, result_table
        from cube_sim.scenario import load

        # A file that is wrong says so before MuJoCo is even loaded.
        loaded = load(self.path)
        from cube_sim.simulation import fly

        # The factory behind pytest's tmp_path, which only function tests can ask for.
        temporary: pytest.TempPathFactory = self.config._tmp_path_factory  # type: ignore[attr-defined]
        directory = temporary.mktemp(self.name)
        result = fly(loaded, out=directory)
        self.user_properties.append(("verdict", result.verdict))
        self.user_properties += [(check.name, check.value) for check in result.checks]
        remarks, said = early_end(result), log_lines(result.log)
        self.user_properties += [("ended_early", remark) for remark in remarks] + [("log", line) for line in said]
        if result.verdict != "PASS":
            title = f"{self.path.name}: {lasted(result, loaded.scenario.duration_s)}, recorded in {directory}"
            table = as_text(result_table(title, result.verdict, result.checks, remarks))
            raise ScenarioFailedError("\n".join([table, *section("log:", said)]))

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        """What was wrong with the scenario or its result; a traceback only for what nobody foresaw."""
        if isinstance(excinfo.value, ScenarioFailedError | CubeSimError):
            return str(excinfo.value)
        return super().repr_failure(excinfo, style)

    def reportinfo(self) -> tuple[Path, None, str]:
        """How pytest names the test."""
        return self.path, None, f"scenario {self.name}"
