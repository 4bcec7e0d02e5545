"""Vehicles to try things on: ours, those of others, some drawn at random, and all of them slightly wrong."""
