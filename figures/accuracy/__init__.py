"""Plots of the cost of accuracy."""
