"""Plots of what accuracy costs."""
