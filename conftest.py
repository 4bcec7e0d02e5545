"""Every scenario in scenarios/ is a test."""

pytest_plugins = ["cube_sim.testing"]
