"""A hull's shape as triangles: what it displaces, how the water moves with it, what it shows to the flow."""
