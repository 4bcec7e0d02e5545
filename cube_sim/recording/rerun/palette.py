"""Colours of the Rerun view: told apart also by readers who do not see red and green apart (Okabe and Ito)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Rgb = tuple[int, int, int]

ORANGE: Rgb = (230, 159, 0)
SKY: Rgb = (86, 180, 233)
GREEN: Rgb = (0, 158, 115)
YELLOW: Rgb = (240, 228, 66)
BLUE: Rgb = (64, 132, 214)
VERMILION: Rgb = (213, 94, 0)
PURPLE: Rgb = (204, 121, 167)
GREY: Rgb = (160, 168, 178)

SERIES = (ORANGE, SKY, GREEN, YELLOW, BLUE, VERMILION, PURPLE, GREY)

WATER: Rgb = (7, 26, 44)
GRID: Rgb = (38, 70, 96)
PATH: Rgb = (190, 205, 220)
TRAIL = YELLOW
TARGET: Rgb = (60, 255, 190)
CURRENT = PURPLE
ESTIMATE = SKY
DUCT: Rgb = (128, 138, 152)
FORWARD = ORANGE
REVERSE = BLUE
IDLE: Rgb = (58, 66, 78)
BAD: Rgb = (220, 50, 60)
SURFACE: Rgb = (48, 92, 124)
LIMIT: Rgb = (235, 70, 80)
EVENT: Rgb = (148, 148, 148)  # seen on the dark and on the light background of the viewer


def series(count: int) -> list[Rgb]:
    """Give ``count`` curves their colours; they repeat after eight."""
    return [SERIES[i % len(SERIES)] for i in range(count)]


def rgba8(rgba: NDArray[np.float64]) -> tuple[int, ...]:
    """Turn (4,) 0 to 1 into 0 to 255."""
    return tuple(int(value) for value in np.rint(np.clip(rgba, 0, 1) * 255))


def by_sign(values: NDArray[np.float64]) -> NDArray[np.uint8]:
    """Colour (n,) forces by their direction: (n, 3)."""
    return np.where((values >= 0)[:, None], np.array(FORWARD), np.array(REVERSE)).astype(np.uint8)
