"""Oracles, families of hard shapes and cases of motion, shared by tests and benchmarks."""
