"""Many flights of one scenario, each with values of its own: drawn, flown, counted."""
