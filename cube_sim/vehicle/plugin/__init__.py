"""The laws inside MuJoCo: its callbacks, its memory, and the parameters packed into a compiled model."""
