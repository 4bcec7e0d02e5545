"""Vehicles of other people, and the common arrangements of thrusters, as tables.

Numbers with a source name it; all others are choices of the size that such vehicles have.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from support.catalogue.mjcf import Hull, Layout, Thruster, box_hull

AHEAD, LEFT, UP = (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)

BLUEROV2_WU = Hull(11.5, (0.16, 0.16, 0.16), (0.4, 0.25, 0.16), (0, 0, 0.02), (5.5, 12.7, 14.57, 0.12, 0.12, 0.12),
                   (4.03, 6.22, 5.18, 0.07, 0.07, 0.07), (18.18, 21.66, 36.99, 1.55, 1.55, 1.55))  # fmt: skip
"""BlueROV2: C.-J. Wu, 6-DoF modelling and control of a remotely operated vehicle, Flinders University (2018)."""

BLUEROV2_BENZON = Hull(13.5, (0.26, 0.23, 0.37), (0.457, 0.338, 0.254), (0, 0, 0.01),
                       (6.36, 7.12, 18.68, 0.189, 0.135, 0.222), (13.7, 0, 33, 0, 0.8, 0),
                       (141, 217, 190, 1.19, 0.47, 1.5), volume=0.0134)  # fmt: skip
"""von Benzon et al. 2022, JMSE 10(12):1898, table A1."""


def vectored(x: float, y: float, z: float, angle_deg: float = 45.0, front: float | None = None) -> list[Thruster]:
    """Four horizontal thrusters, mirrored both ways, each inclined to the x axis."""
    c, s = np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))
    ahead = x if front is None else front
    return [
        Thruster((ahead, -y, z), (c, s, 0)),
        Thruster((ahead, y, z), (c, -s, 0)),
        Thruster((-x, -y, z), (-c, s, 0)),
        Thruster((-x, y, z), (-c, -s, 0)),
    ]


def pair(x: float, y: float, z: float, axis: tuple[float, float, float], reaction_m: float = 0.0) -> list[Thruster]:
    """Two thrusters that push alike, to the left and to the right, turning opposite ways."""
    return [Thruster((x, y, z), axis, reaction_m), Thruster((x, -y, z), axis, -reaction_m)]


def known_layouts() -> dict[str, Layout]:
    """Name -> layout."""
    hover = box_hull(34.0, (0.9, 0.6, 0.45), 0.03, added_share=0.7)
    small = box_hull(12.0, (0.45, 0.32, 0.22), 0.015, added_share=0.7)
    torpedo = replace(
        box_hull(38.0, (1.9, 0.2, 0.2), 0.02, drag_coefficient=0.8),
        # A slender body ahead: Cd 0.25 on its cross-section, added mass 3 % of the displaced one (Lamb 1932, art. 115).
        added_mass=(1.2, 38.0, 38.0, 0.02, 10.0, 10.0),
        linear_damping=(1.0, 15.0, 15.0, 0.3, 10.0, 10.0),
        quadratic_damping=(4.0, 150.0, 150.0, 0.3, 60.0, 60.0),
    )
    rexrov = Hull(1862.87, (525.39, 794.2, 691.23), (2.6, 1.5, 1.6), (0, 0, 0.3),
                  (779.79, 1222.0, 3659.9, 534.9, 842.69, 224.32), (74.82, 69.48, 728.4, 268.8, 309.77, 105.0),
                  (748.22, 992.53, 1821.01, 672.0, 774.44, 523.27))  # fmt: skip
    a, t = 0.45, np.radians(74.53)
    rexrov_thrusters = [
        *(Thruster((s * 0.89, p * 0.334, 0.529), (-s * np.cos(t), -p * 0.8 * np.cos(t), np.sin(t))) for s in (-1, 1)
          for p in (1, -1)),
        *vectored(0.412, 0.505, 0.129),
    ]  # fmt: skip
    hippocampus = [
        Thruster((-0.1, y, z), AHEAD, 0.02 * (1 if y * z > 0 else -1)) for y in (0.055, -0.055) for z in (0.055, -0.055)
    ]
    odin = [
        *(Thruster((a * np.cos(f), a * np.sin(f), 0), (-np.sin(f), np.cos(f), 0)) for f in _quarters(np.pi / 4)),
        *(Thruster((a * np.cos(f), a * np.sin(f), 0), UP) for f in _quarters(0.0)),
    ]
    octahedron = [
        Thruster(0.3 * np.roll(AHEAD, i) * s, np.roll(LEFT, i)) for i in range(3) for s in (1.0, -1.0)
    ]  # each pair pushes along one axis, and turns about another
    return {
        "bluerov2_standard": Layout(BLUEROV2_BENZON, [*vectored(0.156, 0.111, -0.085), *pair(0.0, 0.12, 0.0, UP)]),
        "bluerov2_apart": Layout(BLUEROV2_WU, [*vectored(0.15, 0.092, 0.03), *pair(0.02, 0.109, 0.077, UP, 0.015)]),
        # numbers of the hull as the public simulator of its name has them; places rounded
        "rexrov": Layout(rexrov, rexrov_thrusters, thrust=1200.0, lag_s=0.15),
        "three_astern_up": Layout(small, [*pair(-0.18, 0.12, 0, AHEAD), Thruster((0, 0, 0.05), UP)]),
        "three_low_astern": Layout(small, [*pair(-0.18, 0.12, -0.02, AHEAD, 0.015), Thruster((0.01, 0, 0.05), UP)]),
        "four_astern_verticals_abeam": Layout(small, [*pair(-0.18, 0.12, 0, AHEAD), *pair(0, 0.15, 0.03, UP)]),
        "four_astern_verticals_in_line": Layout(
            small, [*pair(-0.18, 0.12, 0, AHEAD), Thruster((0.15, 0, 0), UP), Thruster((-0.15, 0, 0), UP)]
        ),
        "four_with_one_aside": Layout(
            small, [*pair(-0.18, 0.12, 0, AHEAD), Thruster((0, 0, 0), LEFT), Thruster((0, 0, 0.05), UP)]
        ),
        "four_all_astern": Layout(
            replace(box_hull(11.0, (0.35, 0.18, 0.18), 0.005), mass=11.0), hippocampus, thrust=20.0, lag_s=0.05
        ),
        "five_vectored_one_up": Layout(hover, [*vectored(0.32, 0.2, 0.0), Thruster((0, 0, 0.1), UP)], lag_s=0.05),
        "five_survey": Layout(
            hover, [*pair(-0.3, 0.2, 0, AHEAD), *pair(0.0, 0.25, 0.1, UP), Thruster((0.05, 0, 0), LEFT)], lag_s=0.05
        ),
        "five_three_hulls": Layout(
            hover,
            [*pair(0, 0.3, -0.1, AHEAD), Thruster((0.3, 0, 0), UP), Thruster((-0.3, 0, 0), UP),
             Thruster((0.0, 0, 0), LEFT)],
            lag_s=0.05,
        ),
        "six_two_astern_four_up": Layout(
            hover, [*pair(-0.35, 0.2, 0, AHEAD), *pair(0.3, 0.25, 0.1, UP), *pair(-0.3, 0.25, 0.1, UP)], lag_s=0.05
        ),
        "six_octahedron": Layout(box_hull(33.5, (0.4, 0.4, 0.4), 0.01), octahedron, thrust=20.0, lag_s=0.05),
        "seven_three_verticals": Layout(
            hover, [*vectored(0.32, 0.2, 0.0), *pair(-0.2, 0.2, 0.1, UP), Thruster((0.3, 0, 0.1), UP)], lag_s=0.05
        ),
        "eight_on_a_ball": Layout(box_hull(125.0, (0.6, 0.6, 0.6), 0.02), odin, lag_s=0.05),
        "torpedo_fins": Layout(
            torpedo,
            [Thruster((-0.95, 0, 0), AHEAD, 0.01), Thruster((-0.8, 0, 0), LEFT, share=0.3),
             Thruster((-0.8, 0, 0), UP, share=0.3)],
            thrust=30.0, lag_s=0.05,
        ),
        "torpedo_four_fins": Layout(
            torpedo,
            [Thruster((-0.95, 0, 0), AHEAD), *(Thruster((-0.8, 0, z), LEFT, share=0.2) for z in (0.08, -0.08)),
             *(Thruster((-0.8, y, 0), UP, share=0.2) for y in (0.08, -0.08))],
            thrust=30.0, lag_s=0.05,
        ),
        "torpedo_tunnels": Layout(
            torpedo,
            [Thruster((-0.95, 0, 0), AHEAD), *(Thruster((x, 0, 0), LEFT) for x in (0.6, -0.6)),
             *(Thruster((x, 0, 0), UP) for x in (0.5, -0.5))],
            thrust=30.0, lag_s=0.05,
        ),
    }  # fmt: skip


def _quarters(start: float) -> list[float]:
    return [start + i * np.pi / 2.0 for i in range(4)]
