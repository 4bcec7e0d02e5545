"""What was said, what was set and what was flown on, as tables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from hashlib import sha256

from cube_sim.report.html_table import table
from cube_sim.report.markup import element, seconds, text
from cube_sim.report.parameters import set_parameters
from cube_sim.report.subject import Subject
from cube_sim.run_log import LogEntry, LogLine

_LOG_LINES = 200
"""So many lines of the log are shown; the record has all (choice)."""


def log_table(log: Sequence[LogLine]) -> str:
    """What was said, line after line, repeated sentences once."""
    entries: dict[tuple[str, str], LogEntry] = {}
    for line in log:
        key = line.level, line.text
        known = entries.get(key)
        entries[key] = LogEntry(line, 1, line.t) if known is None else LogEntry(known.first, known.count + 1, line.t)
    rows = []
    for entry in list(entries.values())[:_LOG_LINES]:
        more = f" (+{entry.count - 1} more, the last at {seconds(entry.last_s)})" if entry.count > 1 else ""
        level = text(entry.first.level)
        level = level if entry.first.level in ("INFO", "DEBUG") else element("span", level, class_="hot")
        rows.append((text(seconds(entry.first.t)), level, text(entry.first.text + more)))
    more = len(entries) - len(rows)
    left = f'<p class="dim">and {more} more sentences in the record</p>' if more > 0 else ""
    return table(("at", "level", "said"), rows, "rsw") + left


def parameter_table(subjects: Sequence[Subject]) -> str:
    """What the scenarios set, beside the defaults; what differs between runs stands out."""
    found = [{each.key: each for each in set_parameters(subject.scenario)} for subject in subjects]
    rows = []
    for key in dict.fromkeys(key for keys in found for key in keys):
        given = [keys.get(key) for keys in found]
        default = next(each.default for each in given if each is not None)
        values = [default if each is None else each.value for each in given]
        differ = len({*values}) > 1
        shown = [element("span", text(value or "–"), class_="hot" if differ else None) for value in values]
        rows.append(
            (text(key), *shown, '<span class="dim">has to be given</span>' if default is None else text(default))
        )
    return table(
        ("key", *([subject.label for subject in subjects] if len(subjects) > 1 else ["value"]), "default"),
        rows,
        "w" * (len(subjects) + 2),
    )


def build_table(subjects: Sequence[Subject]) -> str:
    """Versions, and the SHA-256 of each file that was flown on."""
    facts = [_build(subject) for subject in subjects]
    rows = []
    for key in dict.fromkeys(key for each in facts for key in each):
        values = [each.get(key, "–") for each in facts]
        differ = len({*values}) > 1
        rows.append((text(key), *(element("span", text(v), class_="hot" if differ else None) for v in values)))
    header = ("", *([subject.label for subject in subjects] if len(subjects) > 1 else ["as recorded"]))
    return table(header, rows, "s" + "w" * len(subjects), narrow=True)


def _build(subject: Subject) -> Mapping[str, str]:
    header = subject.run.header
    facts = {"seed": str(header.seed), **header.versions}
    facts |= {
        f"SHA-256 of {name}": sha256(data).hexdigest()[:16] + " …" for name, data in sorted(header.inputs.items())
    }
    facts |= {f"{code.key} = {code.name}": f"SHA-256 {code.digest[:16]} …" for code in header.code}
    return facts
