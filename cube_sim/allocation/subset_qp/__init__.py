"""One convex problem per subset of thruster sides, solved by ProxQP."""
