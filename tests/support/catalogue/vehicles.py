"""The catalogue: every vehicle by name, as MJCF text, with the thrusters it has lost."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache

from support.catalogue.drawn import LEAST, MOST, drawn_layout
from support.catalogue.known import known_layouts
from support.catalogue.mjcf import mjcf
from support.places import FLOWN_MODEL_FILES

DRAWN_EACH = 4
"""Random layouts of each number of thrusters."""

PLANAR = ("infante", "jack")
"""Built for the plane at their depth; the analysis is asked for that."""

LOSSES = {
    "cube": ("T1", "T1,T4", "T1,T3,T6", "T1,T3,T5,T7", "T1,T2,T3,T4,T5"),
    "cube_as_built": ("T2,T5", "T1,T2,T3"),
    "bluerov2_heavy": ("T1", "T5", "T1,T5", "T5,T8", "T1,T2,T3", "T5,T6,T7,T8"),
    "bluerov2_vectored": ("T1", "T5", "T5,T6", "T1,T2"),
    "jack": ("T1", "T1,T2", "T1,T2,T3"),
    "infante": ("T1",),
    "three_astern_up": ("T1", "T3"),
    "five_survey": ("T1", "T5"),
    "torpedo_fins": ("T1", "T2"),
    "four_all_astern": ("T1",),
    "rov6": ("FL", "VR"),
    "rexrov": ("T1", "T5,T8"),
    "eight_on_a_ball": ("T1,T5", "T1,T2"),
    "six_octahedron": ("T1",),
}
"""Thrusters that are dead from the start, in layouts of their own."""


@dataclass(frozen=True)
class Entry:
    """A vehicle of the catalogue.

    Attributes:
        name: of the vehicle, with its lost thrusters behind a minus sign.
        make: its MJCF text.
        lost: names of its dead thrusters.
        planar: whether it is one for the plane at its depth.
        speed_m_s: at which its fins steer it; None for one that thrusters steer.
    """

    name: str
    make: Callable[[], str]
    lost: tuple[str, ...] = ()
    planar: bool = False
    speed_m_s: float | None = None


@cache
def catalogue() -> dict[str, Entry]:
    """Name -> vehicle: ours, those of others, drawn ones, and some of them with losses."""
    whole = [Entry(path.stem, path.read_text, planar=path.stem in PLANAR) for path in FLOWN_MODEL_FILES]
    whole += [Entry(name, lambda n=name, v=layout: mjcf(n, v)) for name, layout in known_layouts().items()]
    for m in range(LEAST, MOST + 1):
        for seed in range(DRAWN_EACH):
            name = f"drawn{m}_{seed}"
            whole.append(Entry(name, lambda n=name, s=seed, k=m: mjcf(n, drawn_layout(s, k))))
    entries = {entry.name: entry for entry in whole}
    for name, losses in LOSSES.items():
        for lost in losses:
            whole_one = entries[name]
            entry = replace(whole_one, name=f"{name}-{lost.replace(',', '')}", lost=tuple(lost.split(",")))
            entries[entry.name] = entry
    return entries
