"""The laws inside MuJoCo: callbacks, its memory, the parameters packed into a compiled model."""
