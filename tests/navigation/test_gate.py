"""The gate's numbers are those of the chi-square distribution."""

from __future__ import annotations

import pytest
from scipy.special import chdtri

from cube_sim.navigation.gate import FALSE_ALARM_PROBABILITY, GATES


@pytest.mark.parametrize("components", sorted(GATES))
def test_a_reading_as_good_as_stated_is_rejected_as_often_as_said(components):
    assert GATES[components] == pytest.approx(chdtri(components, FALSE_ALARM_PROBABILITY), rel=1e-14)
