"""Who touches whom, where, and how deep."""
