"""Which wrenches the thrusters attain within their limits."""
