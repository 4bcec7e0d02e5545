"""One picture of many missions: how far off each was, and what became of those that missed."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from flights.tables import cause_group


def draw(rows: Sequence[dict[str, Any]], path: Path) -> None:
    """Cross-track RMS over its limit by kind, passes and misses by vehicle, causes of misses."""
    import matplotlib

    matplotlib.use("Agg")
    import numpy as np
    from matplotlib import pyplot as plt

    called = [row for row in rows if row.get("forecast")]
    missed = [row for row in called if not row.get("passes")]
    kinds = sorted({row["kind"] for row in called})
    vehicles = sorted({row["vehicle"] for row in called}, reverse=True)
    causes = Counter(cause_group(row) for row in missed).most_common()
    palette = plt.get_cmap("tab10")
    colour = {cause: palette(i % 10) for i, (cause, _) in enumerate(causes)}
    height = max(6.0, 0.17 * len(vehicles))
    figure, (left, middle, right) = plt.subplots(
        1, 3, figsize=(17, height), width_ratios=(1.3, 1.2, 0.8), layout="constrained"
    )
    rng = np.random.default_rng(0)
    for row in called:
        ratio = 1e3 if row.get("rms_m") is None else min(max(row["rms_m"] / row["limit_m"], 1e-3), 1e3)
        x = kinds.index(row["kind"]) + rng.uniform(-0.3, 0.3)
        left.plot(x, ratio, "o", ms=4, color="#9aa5b1" if row.get("passes") else colour[cause_group(row)])
    left.axhline(1.0, color="k", lw=0.8, ls="--")
    left.set_yscale("log")
    left.set_xticks(range(len(kinds)), kinds, rotation=40, ha="right")
    left.set_ylabel("cross-track RMS over its limit")
    left.set_title(f"{len(called) - len(missed)} of {len(called)} pass; grey passes")
    passed = [sum(bool(r.get("passes")) for r in called if r["vehicle"] == v) for v in vehicles]
    middle.barh(vehicles, passed, color="#9aa5b1")
    start = np.array(passed, float)
    for cause, _ in causes:
        extra = np.array([sum(r["vehicle"] == v and cause_group(r) == cause for r in missed) for v in vehicles], float)
        middle.barh(vehicles, extra, left=start, color=colour[cause])
        start += extra
    middle.tick_params(axis="y", labelsize=6)
    middle.set_xlabel("missions that the analysis calls flyable")
    if causes:
        names, numbers = zip(*reversed(causes), strict=True)
        right.barh(names, numbers, color=[colour[name] for name in names])
    right.set_title("what became of the others")
    figure.savefig(path, dpi=130)
    plt.close(figure)
