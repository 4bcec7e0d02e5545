"""What an actuation matrix can and cannot do, with all its thrusters and without some (report, sections 4.1, 4.2)."""
