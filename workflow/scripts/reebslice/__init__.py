"""Certified Reeb graphs of closed meshes from their level sets."""

__version__ = "0.1.0"
