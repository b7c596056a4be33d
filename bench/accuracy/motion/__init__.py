"""Error and CPU time of the integrators, beside MuJoCo and PyBullet, and of the effects."""
