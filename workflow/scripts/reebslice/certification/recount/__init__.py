"""Recounts: what follows from the mesh, by code of its own."""
