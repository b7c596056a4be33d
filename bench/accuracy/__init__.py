"""What accuracy costs: errors over CPU time, of collision and of motion; writes docs/accuracy."""
