"""A first scenario for a vehicle: chosen by flying, so that the file that is written passes."""

from __future__ import annotations

import json
import os
import re
import tempfile
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import ceil, floor, log10
from pathlib import Path
from typing import TYPE_CHECKING

from cube_sim.errors import CubeSimError

if TYPE_CHECKING:
    from cube_sim.commands.analysis_report import Report
    from cube_sim.verdict import CheckResult

DEPTH_M = -5.0
_PLAIN = re.compile(r"(?:\.\./)*[A-Za-z_][A-Za-z0-9_./-]*")
_LINE = re.compile(r"^(\d+(:\d+)?:)?")
"""Of a file that is gone when its error is read."""
_SLACK = 2.0
"""The limits of the checks that are written over what was measured."""
_LEAST_LIMIT_M = 0.05
_SLOWEST = 0.5
"""Share of its speed at which a target that never arrives has to move on."""
BEYOND_CRITICAL = "is beyond this vehicle's critical speed of"
"""What the log says at the beginning of a mission that is too fast for the hull's stability."""
_FURTHEST_M, _REACH_M = 0.1, 0.5
"""Cross-track RMS up to which a path counts as followed, and distance to its end up to which that is reached."""


@dataclass(frozen=True)
class Candidate:
    """A mission that may suit a vehicle.

    Attributes:
        what: it is, in words.
        path: its path block, in YAML.
        position_m: where it starts, a little beside the path.
        speed_m_s: along the path.
        duration_s: of the run; the second half is judged.
        ends: whether the path's end is reached before that.
        progresses: whether its target has to move on while it is judged, at half its speed.
        guidance: further keys of that block.
        control: keys of that block.
        under_way: whether it starts with its speed, not at rest.
    """

    what: str
    path: str
    position_m: tuple[float, float, float]
    speed_m_s: float
    duration_s: float
    ends: bool = True
    progresses: bool = False
    guidance: Mapping[str, str] | None = None
    control: Mapping[str, str] | None = None
    under_way: bool = False


@dataclass(frozen=True)
class Starter:
    """A mission that a vehicle flies.

    Attributes:
        candidate: it.
        limits: of its checks, by what they look at.
        measured: what the flight showed, likewise.
    """

    candidate: Candidate
    limits: Mapping[str, float]
    measured: Mapping[str, float]


class NoStarterError(CubeSimError):
    """Nothing that was tried is flown by a vehicle; the text says what, and why not."""


def candidates() -> Iterator[Candidate]:
    """What is tried, the most telling first: in space, on a level, at a point, and for hulls that only fly ahead."""
    helix = f"{{type: helix, centre_m: [0, 0, {DEPTH_M:g}], radius_m: 4, pitch_m: 1.5, turns: 1}}"
    level = f"{{type: sinusoid, start_m: [0, 0, {DEPTH_M:g}], amplitude_m: 1, wavelength_m: 20, periods: 1}}"
    for attitude in ("along_path", "free"):
        control = None if attitude == "along_path" else {"attitude": "{mode: free}"}
        yield Candidate("a turn of a helix", helix, (4.0, -0.5, DEPTH_M), 0.3, 120, control=control)
    for speed in (0.3, 0.5):
        duration = ceil(25 / speed / 10) * 10 + 20
        yield Candidate("a level wave", level, (0.0, 0.5, DEPTH_M), speed, duration)
    for speed in (0.4, 0.8, 1.5):
        line = f"{{type: line, start_m: [0, 0, {DEPTH_M:g}], end_m: [{ceil(speed * 130)}, 0, {DEPTH_M:g}]}}"
        on = {"stop_at_end": "false"}
        yield Candidate("a line, joined from beside it", line, (0.0, 0.5, DEPTH_M), speed, 120, False, True, on)
    point = f"{{type: point, position_m: [0, 0, {DEPTH_M:g}]}}"
    yield Candidate("a point to hold", point, (1.0, 1.0, DEPTH_M), 0.3, 60, ends=False)


def candidates_by_fins() -> Iterator[Candidate]:
    """What is tried with a vehicle that its fins steer: at rest they make nothing, and slower they make less."""
    for speed in (0.8, 1.2, 1.5, 2.0):
        line = f"{{type: line, start_m: [0, 0, {DEPTH_M:g}], end_m: [{ceil(speed * 310)}, 0, {DEPTH_M:g}]}}"
        on = {"stop_at_end": "false"}
        yield Candidate(
            "a line, joined under way", line, (0.0, 0.5, DEPTH_M), speed, 300, False, True, on, under_way=True
        )


def starter_for(
    model: Path, hull: str | None, tried: Sequence[Candidate] | None = None, battery: Mapping[str, str] | None = None
) -> Starter:
    """The first candidate that a vehicle flies well, below its critical speed if there is one.

    Args:
        model: the MJCF file.
        hull: name of the hull, where the model has several.
        tried: in their order; None: all of `candidates`.
        battery: keys of that block, which feeds the thrusters; None for none.

    Raises:
        NoStarterError: there is none.
    """
    from cube_sim import simulation

    refused, too_fast = [], None
    with tempfile.TemporaryDirectory() as folder:
        for number, candidate in enumerate(candidates() if tried is None else tried):
            scenario = Path(folder, f"{number}.yaml")
            scenario.write_text(
                text_of(candidate, model, hull, _first_limits(candidate), scenario.parent, battery=battery)
            )
            try:
                run = simulation.fly(scenario, out=Path(folder, str(number)), record="none")
            except CubeSimError as error:
                reason = _LINE.sub("", str(error).splitlines()[0].removeprefix(f"{scenario}:")).strip()
                refused.append(f"{_told(candidate)}: {reason}")
                continue
            if run.verdict == "PASS":
                values = [check.value or 0.0 for check in run.checks]
                measured = dict(zip(_checked(candidate), values, strict=False))
                starter = Starter(candidate, {name: _limit(value) for name, value in measured.items()}, measured)
                if not any(BEYOND_CRITICAL in line.text for line in run.log):
                    return starter
                too_fast = too_fast or starter
                continue
            failed = next(check for check in run.checks if check.verdict != "PASS")
            refused.append(f"{_told(candidate)}: {_failure(failed)}")
    if too_fast is not None:
        return too_fast
    raise NoStarterError("\n".join([f"{model}: flies none of the paths that were tried", *refused]))


def _told(candidate: Candidate) -> str:
    free = ", attitude free" if candidate.control else ""
    return f"{candidate.what} at {candidate.speed_m_s:g} m/s{free}"


def _failure(failed: CheckResult) -> str:
    """What a check saw, and what it should have seen."""
    if failed.value is None:
        return f"{failed.name}: {failed.detail}"
    unit = "" if failed.unit in ("", "1") else f" {failed.unit}"
    limit = "at most" if failed.relation == "<=" else "at least"
    return f"{failed.name}: {failed.value:.3g}{unit}, {limit} {failed.limit:g}{unit} is right"


def _checked(candidate: Candidate) -> tuple[str, ...]:
    return ("rms", "end") if candidate.ends else ("rms",)


def _first_limits(candidate: Candidate) -> dict[str, float]:
    return dict(zip(_checked(candidate), (_FURTHEST_M, _REACH_M), strict=False))


def _limit(measured: float) -> float:
    """Twice what was measured, rounded up to one digit, and no less than some centimetres."""
    wanted = max(_SLACK * measured, _LEAST_LIMIT_M)
    digit = 10.0 ** floor(log10(wanted))
    return float(f"{ceil(wanted / digit * (1 - 1e-9)) * digit:.6g}")


def text_of(
    candidate: Candidate,
    model: Path,
    hull: str | None,
    limits: Mapping[str, float],
    folder: Path,
    head: Sequence[str] = (),
    measured: Mapping[str, float] | None = None,
    thrusters: Sequence[str] = (),
    battery: Mapping[str, str] | None = None,
) -> str:
    """A scenario file.

    Args:
        candidate: what it flies.
        model: the MJCF file.
        hull: name of the hull, where the model has several.
        limits: of the checks.
        folder: in which the file will stand.
        head: lines of remarks at its top.
        measured: by the flight that chose it.
        thrusters: names; of the first an event is shown, as a remark.
        battery: keys of that block; None for none.
    """
    x, y, z = candidate.position_m
    half = candidate.duration_s / 2
    lines = [f"# {line}".rstrip() for line in head]
    lines += [
        "schema_version: 1",
        f"name: {_name(model)}_first",
        f"description: {candidate.what.capitalize()}, as `cube-sim new` chose it.",
        f"model: {_quoted(os.path.relpath(model.resolve(), folder.resolve()))}",
        *([] if hull is None else [f"vehicle: {_quoted(hull)}"]),
        f"duration_s: {candidate.duration_s:g}",
        "seed: 0   # of everything that is drawn: the same seed, the same run",
        "",
        "current_m_s: [0, 0, 0]   # of the water, world axes (x east, y north, z up); the controller is not told",
        "initial:",
        f"  position_m: [{x:g}, {y:g}, {z:g}]   # a little beside the path: it has to be joined",
        *([f"  velocity_m_s: [{candidate.speed_m_s:g}, 0, 0]   # at rest fins make nothing"] * candidate.under_way),
        "",
        f"path: {candidate.path}",
        "guidance:",
        f"  speed_m_s: {candidate.speed_m_s:g}",
        *(f"  {key}: {value}" for key, value in (candidate.guidance or {}).items()),
    ]
    if candidate.control:
        lines += ["control:", *(f"  {key}: {value}" for key, value in candidate.control.items())]
    if battery:
        lines += ["", "battery:", *(f"  {key}: {value}" for key, value in battery.items())]
    if thrusters:
        lines += [
            "",
            "# events:   # take the # away: a thruster dies, the current sets in",
            f"#   - {{kind: thrusters, at_s: {half:g}, thrusters: [{thrusters[0]}], state: dead}}",
            f"#   - {{kind: current, at_s: {half:g}, current_m_s: [0.1, 0, 0]}}",
            "",
            "# navigation: {}   # fly on sensors with noise, bias and delay instead of on the true state",
        ]
    of_flight = _remarks(measured or {})
    lines += [
        "",
        "checks:   # what the run must show; `cube-sim signals` lists what a check can look at",
        "  - kind: signal",
        "    name: cross-track RMS after convergence",
        "    signal: path_error.cross_track",
        "    statistic: rms",
        f"    from_s: {half:g}",
        f"    at_most: {limits['rms']:g}{of_flight['rms']}",
    ]
    if candidate.ends:
        lines += [f"  - {{kind: path_end, reach_m: {limits['end']:g}}}{of_flight['end']}"]
    if candidate.progresses:
        on = f"{{kind: progress, from_s: {half:g}, at_least_m_s: {_SLOWEST * candidate.speed_m_s:g}}}"
        lines += [f"  - {on}   # who only drifts onto the path does not follow it"]
    lines += ["  - {kind: allowed_forces}   # every thruster force within its limits, outside its dead zone"]
    return "\n".join(lines) + "\n"


def head_of(report: Report) -> list[str]:
    """What the analysis says of the vehicle, in lines of remarks."""
    vehicle, analysis = report.vehicle, report.analysis
    both = zip(vehicle.thrusters.names, vehicle.thrusters.limits, strict=True)
    limits = [f"{name} {low:.3g} to {high:.3g} N" for name, (low, _, _, high) in both]
    follows = "yes" if analysis.verdict.follows else "no"
    return [
        f"A first scenario of {report.title}, written by `cube-sim new`; it passes as it is.",
        "",
        *_folded(f"Thrusters: {', '.join(limits)}."),
        f"Rank {analysis.rank} of {len(analysis.subspaces.axes.names)}, {analysis.redundancy} redundant.",
        *_folded(f"Follows paths in space: {follows}; {analysis.verdict.reason}."),
        "",
        "Every key: docs/scenario.md, or `cube-sim reference scenario`. `cube-sim validate FILE` looks at it,",
        "`cube-sim run FILE` flies it, `cube-sim run FILE --set guidance.speed_m_s=0.2` with another value.",
        "",
    ]


def _folded(text: str) -> list[str]:
    return textwrap.wrap(text, 110, break_long_words=False, break_on_hyphens=False)


def _remarks(measured: Mapping[str, float]) -> dict[str, str]:
    said = {name: f"   # [m]; {value:.2g} m as it is here" for name, value in measured.items()}
    return {"rms": "", "end": "", **said}


def _name(model: Path) -> str:
    """A scenario's name after a model's file."""
    return re.sub(r"[^A-Za-z0-9_.-]", "_", model.stem).lstrip("_.-")[:80] or "vehicle"


def _quoted(text: str) -> str:
    """A YAML scalar: as it is where that is plain text, in quotes elsewhere."""
    return text if _PLAIN.fullmatch(text) else json.dumps(text, ensure_ascii=False)
