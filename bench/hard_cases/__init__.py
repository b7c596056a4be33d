"""The hard cases of collision and motion in large numbers."""
