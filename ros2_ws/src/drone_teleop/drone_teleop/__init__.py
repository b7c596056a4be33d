"""Keyboard teleoperation: keys typed in the terminal become commands."""
