"""Which directions of the wrench a thruster layout makes, at what cost, and which it loses."""
