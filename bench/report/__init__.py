"""Timing of calls, and the table and JSON file of each benchmark."""
