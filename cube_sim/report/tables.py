"""What became of the checks, of the thrusters and of the sensors, as tables."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cube_sim.report import colours
from cube_sim.report.circumstances import circumstances
from cube_sim.report.happenings import Happening
from cube_sim.report.html_table import badge, name_of, table
from cube_sim.report.judged_quantity import JudgedQuantity, beyond_from, judged_quantity
from cube_sim.report.markup import element, number, seconds, text
from cube_sim.report.motion_panels import LIKELY, sensor_names
from cube_sim.report.subject import Subject
from cube_sim.report.thruster_use import LOST, LOWER, NEAR, NEAR_OVER_S, OFF, UPPER, ThrusterUse
from cube_sim.scenario.check_blocks import AnyCheck, BeforeAfterCheckBlock, SignalCheckBlock
from cube_sim.scenario.statistic_keys import statistic_alone
from cube_sim.verdict import CheckResult


def check_table(subject: Subject) -> str:
    """The checks of one run: value, limit, margin, and what else was the case."""
    rows = []
    for check, result in zip(subject.scenario.checks, subject.results, strict=True):
        quantity = judged_quantity(subject, check)
        unit = result.unit if quantity.apart else quantity.unit
        unit = f" {unit}" if unit not in ("", "1") else ""
        statistic = _statistic_words(check)
        rows.append(
            (
                badge(result.verdict),
                f'{text(result.name)}<br><span class="dim">{text(statistic + quantity.title)}</span>'.replace(
                    "<br>", "<br/>"
                ),
                "–" if result.value is None else text(number(result.value) + unit),
                text(f"{'≤' if result.relation == '<=' else '≥'} {number(result.limit)}{unit}"),
                _margin(result),
                "" if result.at_s is None else text(seconds(result.at_s)),
                _account(subject, result, quantity),
            )
        )
    header = ("", "check", "value", "limit", "margin", "worst at", "what was the case then")
    return table(header, rows, "skrrrrw")


def _statistic_words(check: AnyCheck) -> str:
    match check:
        case SignalCheckBlock():
            return f"{statistic_alone(check).replace('_', ' ')} of "
        case BeforeAfterCheckBlock():
            sign = "−" if check.compare == "difference" else "/"
            return f"{statistic_alone(check).replace('_', ' ')}, after {sign} before, of "
        case _:
            return ""


def comparison_table(subjects: Sequence[Subject]) -> str:
    """Several runs, a column each: verdict, checks, and figures of the flight."""
    rows = [
        ("verdict", *(badge(subject.verdict) for subject in subjects)),
        ("scenario", *(text(subject.scenario.name) for subject in subjects)),
        ("flown", *(text(_flown(subject)) for subject in subjects)),
    ]
    results = [{result.name: result for result in subject.results} for subject in subjects]
    rows += [
        (text(name), *(_brief(s, found.get(name)) for s, found in zip(subjects, results, strict=True)))
        for name in dict.fromkeys(name for found in results for name in found)
    ]
    for label, signal, unit in (
        ("cross-track error, RMS", "path_error.cross_track", "m"),
        ("cross-track error, largest", "path_error.cross_track", "m"),
        ("attitude error, RMS", "path_error.attitude", "rad"),
        ("energy drawn", "power.energy", "J"),
    ):
        statistic = "largest" if "largest" in label else "last" if "energy" in label else "rms"
        values = [_statistic(subject, signal, statistic) for subject in subjects]
        rows.append((text(f"{label} [{unit}]"), *(number(value) for value in values)))
    rows.append(("thrusters at a limit [s], all added", *(number(_at_limits(subject)) for subject in subjects)))
    header = ("", *(subject.label for subject in subjects))
    return table(header, rows, "s" + "w" * len(subjects))


def happening_table(subjects: Sequence[Subject], told: Sequence[tuple[str, Happening, Sequence[Subject]]]) -> str:
    """What happened, by the flags on the plots."""
    several = len(subjects) > 1
    rows = []
    for flag, each, whose in told:
        cells = (element("b", text(flag)), text(seconds(each.t)), text(each.kind), text(each.text))
        names = " ".join(name_of(subject) for subject in whose) if len(whose) < len(subjects) else "all"
        rows.append((*cells, names) if several else cells)
    header = ("", "at", "kind", "what happened", *(("run",) if several else ()))
    return table(header, rows, "srsws" if several else "srsw", narrow=True)


def thruster_table(subject: Subject) -> str:
    """What each thruster was asked for, in numbers."""
    rows = []
    for use in subject.thrusters:
        whole = max(use.period_s * len(use.times), 1e-9)
        at = {state: use.time_in(state) for state in (LOWER, UPPER, OFF, LOST)}
        first = min((use.spans(LOWER, UPPER) or [(None, None)])[:1])[0]
        longest = max((b - a for a, b in use.spans(LOWER, UPPER)), default=0.0)
        rows.append(
            (
                element("b", text(use.name)),
                f"{number(float(np.nanmin(use.force)), 3)} … {number(float(np.nanmax(use.force)), 3)}",
                number(float(np.sqrt(np.nanmean(use.force**2))), 3),
                _limits(use),
                _share_of(at[LOWER], whole),
                _share_of(at[UPPER], whole),
                "–" if first is None else seconds(first),
                seconds(longest) if longest else "–",
                _near(use, whole),
                _share_of(at[OFF], whole, hot=False),
                _share_of(at[LOST], whole),
                str(use.reversals),
                number(use.energy_J, 3),
            )
        )
    header = ("", "force [N]", "RMS [N]", "limits: reverse, forward [N]", "at lower limit", "at upper limit")
    header += (
        "first at one",
        "longest",
        f"≥ {100 * NEAR:.0f} % of one, mean of {NEAR_OVER_S:g} s",
        "off",
        "believed dead",
        "reversals",
        "energy [J]",
    )
    return table(header, rows, "srrrrrrrrrrrr")


def sensor_table(subjects: Sequence[Subject]) -> str:
    """Readings of each sensor, and how well they agreed with the estimate."""
    rows = []
    for subject in subjects:
        for name in sensor_names(subjects):
            outcome, surprise = subject.rows(f"sensor_{name}.outcome"), subject.rows(f"sensor_{name}.surprise")
            if not len(outcome):
                continue
            innovation = subject.rows(f"sensor_{name}.innovation")
            width = innovation.shape[1] - 1
            likely = LIKELY.get(width)
            below = "–" if likely is None else f"{100 * float(np.mean(surprise[:, 1] < likely)):.0f} %"
            kept_out = int(np.sum(outcome[:, 1] == 1))
            rms = float(np.sqrt(np.nanmean(np.sum(innovation[:, 1:] ** 2, axis=1))))
            rows.append(
                (
                    text(name) if len(subjects) == 1 else f"{name_of(subject)} {text(name)}",
                    str(len(outcome)),
                    element("span", str(kept_out), class_="hot") if kept_out else "0",
                    str(int(np.sum(outcome[:, 1] == 2))),
                    f"{number(rms, 3)} {text(subject.unit(f'sensor_{name}.innovation'))}",
                    number(float(np.nanmean(surprise[:, 1])) / width, 3),
                    below,
                )
            )
    header = ("sensor", "readings", "kept out by the gate", "fused in spite of it", "innovation, RMS")
    return table((*header, "surprise / width (1 expected)", "within the 95 % expected"), rows, "srrrrrr", narrow=True)


def _account(subject: Subject, result: CheckResult, quantity: JudgedQuantity) -> str:
    """Why it is so, as far as the record tells: when the limit was first passed, and what was the case at that time."""
    if result.value is None or result.at_s is None or result.verdict == "ERROR":
        return text(result.detail)
    lines = [text(line) for line in circumstances(subject, result.at_s)]
    first = beyond_from(quantity, result.relation, result.limit) if quantity.every_sample else None
    if result.verdict == "FAIL" and first is not None and first < result.at_s:
        then = "; ".join(text(line) for line in circumstances(subject, first)) or "nothing out of the ordinary"
        begins = element("span", text(f"Beyond the limit from {seconds(first)}"), class_="hot")
        worst = element("span", text(f"Worst at {seconds(result.at_s)}"), class_="hot")
        return f"{begins}: {then}.<br/>{worst}: {'; '.join(lines) or 'nothing out of the ordinary'}."
    return "; ".join(lines) or '<span class="dim">nothing out of the ordinary</span>'


def _brief(subject: Subject, result: CheckResult | None) -> str:
    """One check of one run of several."""
    if result is None:
        return '<span class="dim">not asked</span>'
    colour = colours.of_verdict(result.verdict)
    said = f'<b style="color:{colour}">{text(result.verdict)}</b> '
    if result.value is None or result.at_s is None or result.verdict == "ERROR":
        return said + text(result.detail)
    sign = "≤" if result.relation == "<=" else "≥"
    asked = "" if result.verdict == "PASS" else ", must be"
    said += text(f"{number(result.value)}{asked} {sign} {number(result.limit)}, margin {number(result.margin)}")
    said += f' <span class="dim">at {text(seconds(result.at_s))}</span>'
    if result.verdict != "FAIL":
        return said
    check = next(each for each in subject.scenario.checks if each.title == result.name)
    return f"{said}<br/>{_account(subject, result, judged_quantity(subject, check))}"


def _margin(result: CheckResult) -> str:
    shown = text(number(result.margin))
    return element("span", shown, class_="hot") if result.margin is not None and result.margin < 0 else shown


def _flown(subject: Subject) -> str:
    whole = subject.scenario.duration_s
    last = subject.run.recorded_s
    return f"{seconds(whole)}" if last >= whole - 1e-9 else f"{seconds(last)} of {seconds(whole)}"


def _statistic(subject: Subject, signal: str, statistic: str) -> float | None:
    values = subject.rows(signal)[:, 1]
    values = values[np.isfinite(values)]
    if not len(values):
        return None
    if statistic == "rms":
        return float(np.sqrt(np.mean(values**2)))
    return float(np.max(np.abs(values))) if statistic == "largest" else float(values[-1])


def _at_limits(subject: Subject) -> float:
    return sum(use.time_in(LOWER, UPPER) for use in subject.thrusters)


def _share_of(lasted: float, whole: float, *, hot: bool = True) -> str:
    if lasted == 0:
        return "–"
    shown = f"{number(lasted, 3)} s<br/>{100 * lasted / whole:.2g} %"
    return element("span", shown, class_="hot") if hot else shown


def _near(use: ThrusterUse, whole: float) -> str:
    """How long it was near a limit, on average over a while, and the largest share of one so asked for."""
    if not np.isfinite(use.shares).any():
        return "–"
    largest = f"at most {100 * float(np.nanmax(use.shares)):.0f} %"
    near = use.period_s * float(np.sum(use.shares >= NEAR))
    return f"{_share_of(near, whole)}<br/>{largest}" if near else largest


def _limits(use: ThrusterUse) -> str:
    """Those of the start: a change is seen on the plot."""
    more = ", at first" if np.any(use.limits[:, 1:] != use.limits[0, 1:]) else ""
    lowest, dead_below, dead_above, highest = (number(float(limit), 3) for limit in use.limits[0, 1:])
    return f"{lowest} … {dead_below}, {dead_above} … {highest}{more}"
