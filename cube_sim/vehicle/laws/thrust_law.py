"""The thruster characteristic as a law for the compiled callback: plain Python on scalars and arrays.

It is the steady curve of `cube_sim.vehicle.characteristic` (report 3.3.3, figure 4).
"""

from __future__ import annotations

from cube_sim.native.compiled import compiled


@compiled
def between(x, x_low, x_high, y_low, y_high):
    """y(x) on the straight line through (x_low, y_low) and (x_high, y_high)."""
    return y_low + (x - x_low) / (x_high - x_low) * (y_high - y_low)


@compiled
def interpolate(x, xs, ys):
    """Piecewise linear y(x) through the points xs (n,), increasing, and ys (n,); constant beyond the ends."""
    last = xs.shape[0] - 1
    if x <= xs[0]:
        return ys[0]
    if x >= xs[last]:
        return ys[last]
    low, high = 0, last
    while high - low > 1:
        middle = (low + high) // 2
        if xs[middle] <= x:
            low = middle
        else:
            high = middle
    return between(x, xs[low], xs[high], ys[low], ys[high])


@compiled
def force_of_command(command, dead_low, dead_high, commands, forces):
    """Steady force [N] of one command: `Characteristic.force`.

    Args:
        command: normalised command after the motor's lag.
        dead_low: c_DZ-, the command at which the dead zone begins.
        dead_high: c_DZ+, the command at which it ends.
        commands: (n,) increasing commands of the curve.
        forces: (n,) forces [N].
    """
    if dead_low <= command <= dead_high:
        return 0.0
    return interpolate(command, commands, forces)
