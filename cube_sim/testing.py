"""Pytest plugin: every scenario is a test that flies it.

Name it in the conftest at the root of a repository: ``pytest_plugins = ["cube_sim.testing"]``; or ask for it by
``-p cube_sim.testing``. It does not load itself: an installed simulator should not change what pytest does elsewhere.

A YAML file below what pytest is told to look at is a scenario by what it holds, see `cube_sim.scenario.finding`, not by
its name or folder; other YAML is left alone, and said once at the end. A scenario that cannot be read is a failing
test, not an error of the whole session. A scenario with samples is a test for each of them, `hover[s3]`.

Verdict, each check's value, an early end and what the run's log says at the level WARNING or above go into the test's
user properties, and so into JUnit reports; a test that fails shows them, and the command that flies it again.

The tests carry the marker ``flight``, which the plugin registers: ``pytest -m "not flight"`` leaves them out.
"""

from __future__ import annotations

import re
import shlex
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from cube_sim.errors import CubeSimError
from cube_sim.scenario.finding import is_of_a_run, is_scenario

if TYPE_CHECKING:
    from cube_sim.scenario.fleet_loading import AnyLoaded
    from cube_sim.simulation import Kept, Run

MOST_SAMPLES = 20
"""Of a scenario's samples, so many are tests unless more are asked for; a sweep flies all of them."""
_KEEP = ("all", "failures", "none")
_FIRST = re.compile(r"first:(\d+)")
_RANGE = re.compile(r"(\d+)(?:-(\d+))?")
_NAMED_SAMPLE = re.compile(r"\[s(\d+)")
_others: pytest.StashKey[set[str]] = pytest.StashKey()
_left_out: pytest.StashKey[set[str]] = pytest.StashKey()
_found: pytest.StashKey[int] = pytest.StashKey()
_WORKER_SAYS = "cube_sim_found"


class ScenarioFailedError(Exception):
    """A scenario did not pass; the text is what to show."""


def pytest_addoption(parser: pytest.Parser) -> None:
    """The options of the plugin."""
    group = parser.getgroup("cube_sim", "scenarios of cube_sim")
    group.addoption(
        "--scenario-set",
        action="append",
        default=[],
        metavar="PATH=VALUE",
        help="Replace a value of every scenario, as `cube-sim run --set` does. May be repeated.",
    )
    group.addoption(
        "--scenario-seed",
        action="append",
        type=int,
        default=[],
        metavar="N",
        help="Fly every scenario with this seed, as a test of its own: hover[seed7]. May be repeated.",
    )
    group.addoption(
        "--scenario-samples",
        metavar="WHICH",
        help="Which samples are tests: all, first:9 for nine of them, or those of these numbers, counted from 0, for "
        f"example 0-9,17. Default: first:{MOST_SAMPLES}, none where the scenario requires a pass rate of them; those "
        "that the command line names are tests too.",
    )
    group.addoption(
        "--scenario-out",
        type=Path,
        metavar="DIR",
        help="Folder for the recordings, one below it for each test. Default: pytest's temporary folder.",
    )
    group.addoption(
        "--scenario-keep",
        choices=_KEEP,
        default="all",
        help="Which recordings stay: all, those of failures, or none, when nothing is recorded but the verdict.",
    )


def pytest_configure(config: pytest.Config) -> None:
    """Register the marker, so that --strict-markers knows it in any repository; refuse options that mean nothing."""
    config.addinivalue_line("markers", "flight: flies a scenario from start to end, which takes seconds.")
    config.stash[_others], config.stash[_left_out], config.stash[_found] = set(), set(), 0
    try:
        _overrides(config)
        _wanted(_option(config, "--scenario-samples") or "all", 0)
    except (CubeSimError, ValueError) as error:
        raise pytest.UsageError(str(error)) from None


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_setupnodes() -> None:
    """Leave machine code on disk before several processes look for it: each would make its own."""
    import cube_sim
    from cube_sim.flight.compiled import compile_beside
    from cube_sim.shipped import shipped_root

    if compile_beside():
        cube_sim.Flight(shipped_root(Path(__file__).parent) / "scenarios" / "cube_helix.yaml").fly(50)


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    """Collect scenarios, and take note of other YAML."""
    if file_path.suffix not in (".yaml", ".yml"):
        return None

    if is_of_a_run(file_path):
        return None
    asked_for = any(_same(argument, file_path, parent.config) for argument in parent.config.args)
    if asked_for or is_scenario(file_path):
        parent.config.stash[_found] += 1
        return ScenarioFile.from_parent(parent, path=file_path)
    parent.config.stash[_others].add(_shown(file_path, parent.config))
    return None


def pytest_sessionfinish(session: pytest.Session) -> None:
    """Let a process of pytest-xdist tell what it has found."""
    stash = session.config.stash
    if hasattr(session.config, "workeroutput"):
        told = (stash[_found], sorted(stash[_others]), sorted(stash[_left_out]))
        session.config.workeroutput[_WORKER_SAYS] = told  # type: ignore[attr-defined]


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node: Any) -> None:
    """Hear what it tells."""
    found, others, left_out = getattr(node, "workeroutput", {}).get(_WORKER_SAYS, (0, (), ()))
    node.config.stash[_found] += found
    node.config.stash[_others] |= set(others)
    node.config.stash[_left_out] |= set(left_out)


def pytest_terminal_summary(terminalreporter: Any, config: pytest.Config) -> None:
    """Say once which YAML files were no scenarios, where there were any, and which samples are no tests."""
    from cube_sim.commands.skipped import said_of_others

    if config.stash[_found]:
        others = [Path(name) for name in sorted(config.stash[_others])]
        for line in (*said_of_others(others), *sorted(config.stash[_left_out])):
            terminalreporter.write_line(line)


def _option(config: pytest.Config, name: str) -> Any:
    return config.getoption(name)


def _same(argument: str, file: Path, config: pytest.Config) -> bool:
    """Whether an argument of the command line names a file."""
    return (config.invocation_params.dir / argument.partition("::")[0]).resolve() == file.resolve()


def _shown(file: Path, config: pytest.Config) -> str:
    return str(file.relative_to(config.rootpath)) if file.is_relative_to(config.rootpath) else str(file)


def _overrides(config: pytest.Config) -> dict[str, Any]:
    from cube_sim.commands.settings import overrides

    return overrides(_option(config, "--scenario-set"))


def _wanted(which: str, count: int) -> list[int]:
    """Which of so many samples are asked for.

    Raises:
        ValueError: that cannot be told.
    """
    if which == "all":
        return list(range(count))
    if first := _FIRST.fullmatch(which):
        return list(range(min(int(first[1]), count)))
    parts = [_RANGE.fullmatch(part.strip()) for part in which.split(",")]
    if not all(parts):
        raise ValueError(f"--scenario-samples {which}: all, first:N, or numbers from 0, for example 0-9,17")
    chosen = {k for part in parts if part for k in range(int(part[1]), int(part[2] or part[1]) + 1)}
    return [k for k in range(count) if k in chosen]


class ScenarioFile(pytest.File):
    """One scenario file."""

    def collect(self) -> Iterator[pytest.Item]:
        """A test, or one for each sample and each seed, named after the file."""
        seeds = _option(self.config, "--scenario-seed") or [None]
        for sample in self._samples():
            for seed in seeds:
                marks = [f"s{sample}"] * (sample is not None) + [f"seed{seed}"] * (seed is not None)
                name = f"{self.path.stem}[{'-'.join(marks)}]" if marks else self.path.stem
                yield ScenarioItem.from_parent(self, name=name, sample=sample, seed=seed)

    def _samples(self) -> list[int] | list[None]:
        """The samples that are tests; None for the scenario itself where it has none, or cannot be read."""
        try:
            if b"samples" not in self.path.read_bytes() and b"include" not in self.path.read_bytes():
                return [None]
            loaded = _loaded(self.path, self.config)
            if loaded.scenario.samples is None:
                return [None]
            from cube_sim.campaign.sampling import count

            number, counted = count(loaded), loaded.scenario.samples.counted
        except (CubeSimError, OSError):  # the test itself will say so
            return [None]
        named = {int(k) for argument in self.config.args for k in _NAMED_SAMPLE.findall(argument) if int(k) < number}
        which = _option(self.config, "--scenario-samples") or ("first:0" if counted else f"first:{MOST_SAMPLES}")
        wanted = sorted({*_wanted(which, number), *named})
        if len(wanted) < number:
            line = f"{_shown(self.path, self.config)}: {len(wanted)} of {number} samples are tests (--scenario-samples)"
            line += ", cube-sim sweep judges the pass rate that they must show" * counted
            self.config.stash[_left_out].add(line)
        return wanted


class ScenarioItem(pytest.Item):
    """Flies one scenario, or a sample of it, and expects PASS."""

    def __init__(self, *, sample: int | None = None, seed: int | None = None, **options: Any) -> None:
        super().__init__(**options)
        self.sample, self.seed = sample, seed
        self.add_marker("flight")

    def runtest(self) -> None:
        """Run the scenario, recording into pytest's temporary folder or the one that was asked for."""
        # A file that is wrong says so before MuJoCo is even loaded.
        loaded = self._loaded()
        from cube_sim.simulation import fly

        keep = _option(self.config, "--scenario-keep")
        directory, record = self._directory(), _recorded(keep)
        run = fly(loaded, out=directory, record=record, keep_signals=record != "none")
        self._tell(run)
        if run.verdict != "PASS":
            raise ScenarioFailedError(self._account(run, loaded))
        if keep == "failures":
            shutil.rmtree(directory)

    def _loaded(self) -> AnyLoaded:

        seed = {} if self.seed is None else {"seed": self.seed}
        loaded = _loaded(self.path, self.config, seed)
        if self.sample is None:
            return loaded
        from cube_sim.campaign.sampling import sample, variation

        self.user_properties += [(f"drawn {path}", value) for path, value in variation(loaded, self.sample).items()]
        return sample(loaded, self.sample)

    def _directory(self) -> Path:
        out: Path | None = _option(self.config, "--scenario-out")
        name = re.sub(r"[^A-Za-z0-9_.-]+", "-", self.name).strip("-")
        if out is not None:
            return out / Path(_shown(self.path, self.config).lstrip("/")).parent / name
        # The factory behind pytest's tmp_path, which only function tests can ask for.
        temporary: pytest.TempPathFactory = self.config._tmp_path_factory  # type: ignore[attr-defined]
        return temporary.mktemp(name)

    def _tell(self, run: Run) -> None:
        """Leave what a JUnit report holds of it."""
        from cube_sim.commands.account import early_end, judged_line, log_lines

        self.user_properties.append(("verdict", run.verdict))
        self.user_properties += [(check.name, check.value) for check in run.checks]
        self.user_properties += [(f"{check.name}: judged", judged_line(check)) for check in run.checks]
        self.user_properties += [("ended_early", remark) for remark in early_end(run)]
        self.user_properties += [("log", line) for line in log_lines(run.log)]

    def _account(self, run: Run, loaded: AnyLoaded) -> str:
        """Table, log, and how to fly it again."""
        from cube_sim.commands.account import early_end, lasted, log_lines, section
        from cube_sim.commands.result_table import as_text, result_table

        recorded = "" if _option(self.config, "--scenario-keep") == "none" else f", recorded in {run.directory}"
        title = f"{self.path.name}: {lasted(run, loaded.scenario.duration_s)}{recorded}"
        table = as_text(result_table(title, run.verdict, run.checks, early_end(run)))
        return "\n".join([table, *section("log:", log_lines(run.log)), "", f"again: {self._command()}"])

    def _command(self) -> str:
        settings = [*_option(self.config, "--scenario-set"), *([] if self.seed is None else [f"seed={self.seed}"])]
        sample = [] if self.sample is None else ["--sample", str(self.sample)]
        told = [word for setting in settings for word in ("--set", setting)]
        return shlex.join(["cube-sim", "run", _shown(self.path, self.config), *sample, *told])

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> Any:
        """What was wrong with the scenario or its result; a traceback only for what nobody foresaw."""
        if isinstance(excinfo.value, ScenarioFailedError | CubeSimError):
            return str(excinfo.value)
        return super().repr_failure(excinfo, style)

    def reportinfo(self) -> tuple[Path, None, str]:
        """How pytest names the test."""
        return self.path, None, f"scenario {self.name}"


def _loaded(path: Path, config: pytest.Config, more: dict[str, Any] | None = None) -> AnyLoaded:
    from cube_sim.scenario.fleet_loading import load_any

    return load_any(path, {**_overrides(config), **(more or {})})


def _recorded(keep: str) -> Kept:
    return "none" if keep == "none" else "full"
