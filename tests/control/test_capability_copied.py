"""A copy of what thrusters can do, made while another thread fills in what is cached of it."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import replace

import numpy as np

from cube_sim.control.judged_capability import capability


class Meanwhile(str):
    """Words whose copying lets something else happen first."""

    __slots__ = ("happens",)

    def __deepcopy__(self, memo):
        """Themselves."""
        self.happens()
        return self


def test_it_is_whole():
    words = Meanwhile("all there")
    left = replace(capability(np.eye(6)), reason=words)
    filled = []
    words.happens = lambda: filled.append(left.onto_range)
    copied = deepcopy(left)
    assert filled
    np.testing.assert_array_equal(copied.onto_range[0], left.onto_range[0])
