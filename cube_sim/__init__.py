"""Underwater vehicles in MuJoCo: water, path following, exact allocation, recordings."""
