"""What a recording's parts are called in the file, and where its time begins."""

from __future__ import annotations

import json
from dataclasses import asdict

from cube_sim.recording.channels import Channel

# 2000-01-01T00:00:00Z. Simulated time starts here in every recording: a recording has no wall clock.
EPOCH_NS = 946_684_800 * 1_000_000_000

FORMAT = "3"
"""1 had the MJCF as `MODEL`, the files it refers to as `ASSETS` and no other inputs. Up to 2, the numbers of a message
had no names, and nothing said how the run ended."""
EARLIER = ("1", "2")
FORMATS = (*EARLIER, FORMAT)
"""Those that are read."""
TRANSFORM_TOPIC = "/tf"
LOG_TOPIC = "/log"
SCENARIO, RESOLVED, CODE = "scenario.yaml", "resolved.yaml", "python/"
MODEL, ASSETS = "model.xml", "assets/"
MODEL_NAME = "model"
RUN_METADATA, VERSIONS_METADATA, CODE_METADATA, CODE_DIGESTS = "cube_sim", "versions", "python", "python_sha256"
END_METADATA, VEHICLES_METADATA = "end", "vehicles"
CHANNEL_METADATA = "channel"


def topic(channel: Channel) -> str:
    """MCAP topic of a channel."""
    return f"/{channel.name}"


def declaration(channel: Channel) -> str:
    """The table of a channel as JSON, as its metadata has it."""
    return json.dumps(asdict(channel), sort_keys=True)


def stamp_ns(t: float) -> int:
    """Time stamp [ns] of a simulated time t [s]."""
    return EPOCH_NS + round(t * 1e9)


def seconds(stamp: int) -> float:
    """Simulated time [s] of a time stamp [ns]."""
    return (stamp - EPOCH_NS) / 1e9
