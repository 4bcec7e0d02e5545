"""The record: MCAP written and read a block at a time."""
