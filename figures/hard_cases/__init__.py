"""Pictures of the hard cases."""
