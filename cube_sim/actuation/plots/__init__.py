"""The analysis as pictures."""
