"""What can be done with a run after it: read, compare, fly again, judge again, hand on."""
