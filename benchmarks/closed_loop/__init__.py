"""The closed loop of controller, thrusters, hull and water, linearised about steady motion."""
