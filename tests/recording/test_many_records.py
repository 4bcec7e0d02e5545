"""Records kept small until they are written."""

from __future__ import annotations

import numpy as np
import pytest

from cube_sim.recording.mcap.many_records import AT_ONCE, ManyRecords


@pytest.mark.parametrize("count", [0, 1, AT_ONCE - 1, AT_ONCE, AT_ONCE + 1, 3 * AT_ONCE + 7])
def test_what_comes_out_is_what_went_in(count):
    rng = np.random.default_rng(count)
    put = [rng.bytes(int(rng.integers(1, 300))) for _ in range(count)]
    kept = ManyRecords()
    for record in put:
        kept.append(record)
    assert len(kept) == count
    assert b"".join(kept) == b"".join(put)
