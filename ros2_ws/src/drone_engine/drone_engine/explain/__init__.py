"""What a scene switches on and off, why, and what each part of a step costs."""
