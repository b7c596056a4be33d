"""Cost of accuracy: errors over CPU time, of collision and of motion; writes docs/accuracy."""
