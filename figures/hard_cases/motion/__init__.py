"""Pictures of the hard cases of motion."""
