"""What an MJCF file may say of a vehicle in water, and what is wrong with it."""
