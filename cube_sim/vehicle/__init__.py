"""MJCF to a vehicle in water: the force law, its hook into MuJoCo, thrusters, and the numbers read back."""
