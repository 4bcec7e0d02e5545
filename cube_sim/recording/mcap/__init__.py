"""The record: MCAP written and read a batch at a time."""
