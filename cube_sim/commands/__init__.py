"""The command line: one file for each command, the tables they print."""
