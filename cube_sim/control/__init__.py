"""From desired motion to a wrench."""
