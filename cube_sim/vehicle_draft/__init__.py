"""A vehicle's MJCF from what its owner knows: a mass, a size or a mesh, and where its thrusters are."""
