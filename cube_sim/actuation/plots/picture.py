"""The analysis as a picture: attainable forces and torques, and what every loss of thrusters leaves."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cube_sim.actuation.attainable.extents import force_corners, torque_corners
from cube_sim.actuation.plots.convex_shape import convex_shape
from cube_sim.actuation.survivability import LossCase, Survivability
from cube_sim.errors import ActuationError
from cube_sim.wrench.axes import Matrix
from cube_sim.wrench.matrix import actuation_matrix

FORMATS = (".png", ".svg", ".pdf")
_INTACT, _DAMAGED, _BAD = "#4a6fa5", "#d9822b", "#c0392b"


def check_path(path: Path) -> None:
    """Refuse a picture that could not be written.

    Raises:
        ActuationError: the suffix is none of `FORMATS`, or there is no such folder.
    """
    if path.suffix.lower() not in FORMATS:
        raise ActuationError(f"{path}: a picture is one of {', '.join(FORMATS)}")
    if not path.parent.is_dir():
        raise ActuationError(f"{path}: there is no folder {path.parent}")


def save_picture(
    path: Path, A: ArrayLike, limits: ArrayLike, table: Survivability, *, names: Sequence[str] = (), title: str = ""
) -> None:
    """Draw the picture of a vehicle; the same numbers give the same file.

    Args:
        path: PNG, SVG or PDF by its suffix.
        A: (6,m) or (3,m) of the intact vehicle.
        limits: as in `cube_sim.actuation.analyse`.
        table: its survivability. What it has lost already is drawn over the intact sets, or else the single loss that
            leaves least force.
        names: (m,) of all thrusters, needed where some are lost already.
        title: of the picture.

    Raises:
        ActuationError: the suffix is none of `FORMATS`, the file cannot be written, or names are missing.
    """
    check_path(path)
    from matplotlib import rc_context
    from matplotlib.figure import Figure

    matrix, axes = actuation_matrix(A)
    m = matrix.shape[1]
    rows = np.broadcast_to(limits, (m, np.shape(limits)[-1]))
    everyone = tuple(names) or table.names
    if len(everyone) != m:
        raise ActuationError(f"{len(everyone)} names for {m} thrusters: give those of the lost ones, too")
    shown = table.already or _worst_single(table)
    keep = [i for i, name in enumerate(everyone) if name not in shown]
    with rc_context({"svg.hashsalt": "cube-sim", "font.size": 9}):
        figure = Figure(figsize=(16, 5.8))
        grid = figure.add_gridspec(1, 3, left=0.05, right=0.96, top=0.86, bottom=0.1, wspace=0.22)
        figure.suptitle(title, fontsize=12)
        for place, corners, names, unit, words in (
            (0, force_corners, axes.names[: axes.forces], "N", "Forces with zero torque"),
            (1, torque_corners, axes.names[axes.forces :], "N m", "Torques with zero force"),
        ):
            spatial = len(names) == 3
            ax = figure.add_subplot(grid[place], projection="3d" if spatial else None)
            _draw(ax, corners(matrix, rows), _INTACT)
            legend = {"all thrusters": _INTACT}
            if keep and len(keep) < m:
                _draw(ax, corners(matrix[:, keep], rows[keep]), _DAMAGED)
                legend[f"without {', '.join(shown)}"] = _DAMAGED
            _label(ax, names, unit, words, legend)
        _failure_matrix(figure, figure.add_subplot(grid[2]), table)
        metadata = {"Software": None} if path.suffix.lower() == ".png" else _undated(path.suffix.lower())
        try:
            figure.savefig(path, dpi=110, metadata=metadata)
        except OSError as error:
            raise ActuationError(f"{path}: {error.strerror or error}") from None


def _undated(suffix: str) -> dict[str, None]:
    return {"Date": None} if suffix == ".svg" else {"CreationDate": None}


def _worst_single(table: Survivability) -> tuple[str, ...]:
    singles = table.of(1)
    return min(singles, key=lambda case: case.strongest_force).lost if singles else ()


def _draw(ax: Any, corners: Matrix, colour: str) -> None:
    from matplotlib.collections import LineCollection, PolyCollection
    from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

    shape = convex_shape(corners)
    dimensions = corners.shape[1]
    if dimensions == 1:
        ends = corners[:, 0]
        ax.plot([ends.min(), ends.max()], [0.0, 0.0], color=colour, linewidth=12, solid_capstyle="butt")
        if shape.dimension == 0:
            ax.plot(ends[:1], [0.0], ".", color=colour, markersize=14, zorder=3)
        return
    faces, lines = (Poly3DCollection, Line3DCollection) if dimensions == 3 else (PolyCollection, LineCollection)
    add = ax.add_collection3d if dimensions == 3 else ax.add_collection
    if shape.faces:
        add(faces(list(shape.faces), facecolors=colour, alpha=0.22, edgecolors="none", linewidths=0))
    if shape.edges:
        add(lines(list(shape.edges), colors=colour, linewidths=1.2 if shape.dimension > 1 else 4))
    # Collections do not widen the axes; a point is all there is to see of dimension 0.
    ax.plot(*corners.T, ".", color=colour, markersize=7, alpha=1.0 if shape.dimension == 0 else 0.0)


def _label(ax: Any, names: tuple[str, ...], unit: str, title: str, legend: dict[str, str]) -> None:
    from matplotlib.patches import Patch

    ax.set_title(title)
    ax.set_xlabel(f"{names[0]} [{unit}]")
    if len(names) == 1:
        ax.set_yticks([])
    else:
        ax.set_ylabel(f"{names[1]} [{unit}]")
    if len(names) == 2:
        ax.set_aspect("equal", adjustable="datalim")
    if len(names) == 3:
        ax.set_zlabel(f"{names[2]} [{unit}]")
        widest = max(abs(end) for ends in (ax.get_xlim(), ax.get_ylim(), ax.get_zlim()) for end in ends)
        ax.set(xlim=(-widest, widest), ylim=(-widest, widest), zlim=(-widest, widest))
        ax.set_box_aspect((1, 1, 1), zoom=0.9)
    patches = [Patch(facecolor=colour, alpha=0.6, label=label) for label, colour in legend.items()]
    ax.legend(handles=patches, loc="upper left", fontsize=8)


def _failure_matrix(figure: Any, ax: Any, table: Survivability) -> None:
    """Diagonal: one loss; above: two; below: the worst third loss on top of the two, and how many can be followed."""
    intact = table.case().strongest_force
    m = len(table.names)
    left = np.full((m, m), np.nan)
    for i, name in enumerate(table.names):
        if table.most >= 1:
            left[i, i] = _cell(ax, i, i, [table.case(name)], intact)
    for i, j in combinations(range(m), 2):
        pair = table.names[i], table.names[j]
        if table.most >= 2:
            left[i, j] = _cell(ax, i, j, [table.case(*pair)], intact)
        if table.most >= 3:
            thirds = [table.case(*pair, name) for name in table.names if name not in pair]
            left[j, i] = _cell(ax, j, i, thirds, intact)
    image = ax.imshow(left, cmap="YlGnBu", vmin=0.0, vmax=1.0)
    figure.colorbar(image, ax=ax, shrink=0.8, pad=0.07, label=f"strongest pure force left, of {intact:.0f} N")
    ax.set_xticks(range(m), table.names)
    ax.set_yticks(range(m), table.names)
    lost = f"Lost besides {', '.join(table.already)}:\n" if table.already else "Lost: "
    ax.set_title(f"{lost}one (diagonal), two (above), worst third (below)", fontsize=10)
    ax.set_xlabel("number: rank left; k/n: third losses after which it follows a path; x: it cannot", fontsize=8)


def _cell(ax: Any, row: int, column: int, cases: list[LossCase], intact: float) -> float:
    worst = min(cases, key=lambda case: (case.verdict.follows, case.strongest_force))
    share = worst.strongest_force / intact if intact > 0.0 else 0.0
    follows = sum(case.verdict.follows for case in cases)
    text = f"{min(case.rank for case in cases)}"
    if len(cases) > 1:
        text += f"\n{follows}/{len(cases)}"
    everywhere = follows == len(cases)
    ax.text(
        column,
        row,
        text if everywhere else f"{text}\nx",
        ha="center",
        va="center",
        fontsize=7,
        color=("white" if share > 0.55 else "black") if everywhere else _BAD,
        fontweight="normal" if everywhere else "bold",
    )
    return share
