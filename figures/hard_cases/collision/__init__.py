"""Pictures of the hard cases of collision: pairs that rounding gets wrong."""
