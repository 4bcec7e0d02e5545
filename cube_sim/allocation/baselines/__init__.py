"""The allocators people compare with, none of which proves its answer."""
