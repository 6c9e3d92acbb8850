"""Checks: what the tables say against what follows from the mesh."""
