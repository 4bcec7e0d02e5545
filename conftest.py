"""Every scenario in scenarios/ is a test; a campaign runs only when it is asked for."""

from __future__ import annotations

import pytest

pytest_plugins = ["cube_sim.testing"]


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave campaigns out, whatever else -m selects, unless it names them."""
    if "campaign" in config.option.markexpr:
        return
    left_out = [item for item in items if item.get_closest_marker("campaign")]
    items[:] = [item for item in items if item not in left_out]
    config.hook.pytest_deselected(items=left_out)
