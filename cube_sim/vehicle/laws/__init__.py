"""The laws of the water and the thrusters: plain Python on scalars and arrays, compiled."""
