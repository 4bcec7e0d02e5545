"""Whether a vehicle follows a path with the thrusters it has: trim, what is controllable there, the verdict."""
