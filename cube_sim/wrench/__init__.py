"""The algebra of F = A f within limits: axes, the checked matrix, limits, facets, health, tolerances."""
