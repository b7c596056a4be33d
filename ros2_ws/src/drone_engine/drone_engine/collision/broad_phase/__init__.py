"""Candidate pairs: a uniform grid."""
