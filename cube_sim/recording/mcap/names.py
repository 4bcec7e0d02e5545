"""What a recording's parts are called in the file, and where its time begins."""

from __future__ import annotations

from cube_sim.recording.channels import Channel

# 2000-01-01T00:00:00Z. Simulated time starts here in every recording: a recording has no wall clock.
EPOCH_NS = 946_684_800 * 1_000_000_000

FORMAT = "2"
"""1 had the MJCF as `MODEL`, the files it refers to as `ASSETS` and no other inputs."""
TRANSFORM_TOPIC = "/tf"
LOG_TOPIC = "/log"
SCENARIO, RESOLVED, CODE = "scenario.yaml", "resolved.yaml", "python/"
MODEL, ASSETS = "model.xml", "assets/"
MODEL_NAME = "model"
RUN_METADATA, VERSIONS_METADATA, CODE_METADATA, CODE_DIGESTS = "cube_sim", "versions", "python", "python_sha256"
CHANNEL_METADATA = "channel"


def topic(channel: Channel) -> str:
    """MCAP topic of a channel."""
    return f"/{channel.name}"


def stamp_ns(t: float) -> int:
    """Time stamp [ns] of a simulated time t [s]."""
    return EPOCH_NS + round(t * 1e9)
