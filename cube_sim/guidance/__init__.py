"""Where the vehicle should be and how fast it should go: paths, the virtual target, the approach to the path."""
