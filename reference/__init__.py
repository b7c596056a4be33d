"""Oracles, families of hard shapes and cases of motion that tests and benchmarks share."""
