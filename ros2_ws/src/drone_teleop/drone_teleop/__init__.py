"""A person's hands: keys in the terminal become commands."""
