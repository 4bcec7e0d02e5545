"""What one plot over time shows, before it is drawn."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal

from cube_sim.report.decimation import Values

Style = Literal["solid", "dashed", "thin", "dots", "crosses"]


@dataclass(frozen=True)
class Curve:
    """One curve.

    Attributes:
        label: in the legend; "" for none.
        times: (n,) increasing [s].
        values: (n,) in the panel's unit.
        colour: CSS.
        style: how it is drawn.
        steps: whether a value holds until the next.
    """

    label: str
    times: Values
    values: Values
    colour: str
    style: Style = "solid"
    steps: bool = False


@dataclass(frozen=True)
class Zone:
    """A shaded region between two curves.

    Attributes:
        label: in the legend; "" for none.
        times: (n,) increasing [s].
        low: (n,) its lower edge; -inf for the end of the axis.
        high: (n,) its upper edge; inf for the end of the axis.
        colour: CSS.
        steps: whether an edge holds until the next.
        shown: whether the axis reaches to its edges.
    """

    label: str
    times: Values
    low: Values
    high: Values
    colour: str
    steps: bool = True
    shown: bool = True


@dataclass(frozen=True)
class Shade:
    """A stretch of time that is shaded from top to bottom.

    Attributes:
        start_s: where it starts [s].
        end_s: where it ends [s].
        colour: CSS.
    """

    start_s: float
    end_s: float
    colour: str


@dataclass(frozen=True)
class Guide:
    """A check, drawn where it was judged: its limit, its value, and the margin between them.

    Attributes:
        name: of the check.
        relation: <= or >=.
        limit: in the panel's unit.
        start_s: where its window starts [s].
        end_s: where its window ends [s].
        verdict: PASS, FAIL or ERROR.
        value: what was compared; None if it could not be judged.
        at_s: when the sample was that speaks most against it [s]; None likewise.
        at_value: that sample; differs from the value where this is a mean; None likewise.
        margin: distance from limit to value, positive where it passes; None likewise.
        colour: of its point.
        every_sample: whether no sample of the window may be beyond the limit.
        apart: whether limit, value and margin are other numbers than the panel's.
        unit: theirs, where they are; "" for a pure number.
        levels: numbers that the check names, in the panel's unit.
    """

    name: str
    relation: str
    limit: float
    start_s: float
    end_s: float
    verdict: str
    value: float | None
    at_s: float | None
    at_value: float | None
    margin: float | None
    colour: str
    every_sample: bool
    apart: bool = False
    unit: str = ""
    levels: tuple[float, ...] = ()


@dataclass(frozen=True)
class Mark:
    """Something that happened, to be marked on every plot.

    Attributes:
        t: when [s].
        flag: its number in the list, or "".
        colour: CSS.
    """

    t: float
    flag: str
    colour: str


@dataclass(frozen=True)
class Panel:
    """One plot over time.

    Attributes:
        title: what it shows.
        unit: of its numbers.
        curves: drawn in order.
        zones: below the curves.
        shades: below all.
        guides: checks judged by what it shows.
        logarithmic: whether equal heights are equal ratios.
        height: of the drawing area [px].
        include: numbers that the axis reaches to in any case.
        note: a remark beside the title.
        focus: the axis reaches to what curves have between these times [s]; beyond them a curve may leave the plot.
    """

    title: str
    unit: str
    curves: tuple[Curve, ...]
    zones: tuple[Zone, ...] = ()
    shades: tuple[Shade, ...] = ()
    guides: tuple[Guide, ...] = ()
    logarithmic: bool = False
    height: int = 150
    include: tuple[float, ...] = ()
    note: str = ""
    focus: tuple[float, float] | None = None


@dataclass(frozen=True)
class TimeAxis:
    """What all panels of a page share.

    Attributes:
        start_s: left end [s].
        end_s: right end [s].
        marks: what happened, in the order of time.
        gaps: from when to when nothing is recorded [s].
        phases: from when to when which leg of the mission was flown [s], with its name.
    """

    start_s: float
    end_s: float
    marks: tuple[Mark, ...] = field(default=())
    gaps: tuple[tuple[float, float], ...] = field(default=())
    phases: tuple[tuple[float, float, str], ...] = field(default=())
