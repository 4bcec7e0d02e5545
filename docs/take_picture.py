"""Take the picture of the README: the viewer showing a run at an instant.

Usage: python docs/take_picture.py logs/cube_helix/run.rrd docs/cube_helix.png --time 62

Needs a Vulkan driver; without a GPU, Debian's mesa-vulkan-drivers will do.
"""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from cube_sim.recording.rerun.screenshot import screenshot


def main() -> int:
    """Take one picture; 1 when a view of it complains."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("rrd", type=Path, help="recording to show")
    parser.add_argument("png", type=Path, help="picture to write")
    parser.add_argument("--time", type=float, required=True, help="simulated time [s]")
    parser.add_argument("--size", type=int, nargs=2, default=(1600, 900), help="window [pixels]")
    arguments = parser.parse_args()
    complaints = screenshot(arguments.rrd, arguments.png, arguments.time, tuple(arguments.size))
    for complaint in complaints:
        print(complaint, file=sys.stderr)
    return 1 if complaints else 0


if __name__ == "__main__":
    sys.exit(main())
