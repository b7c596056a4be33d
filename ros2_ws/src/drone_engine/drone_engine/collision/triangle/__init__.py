"""Triangle against triangle: exact intersection test, contact, closest points."""
