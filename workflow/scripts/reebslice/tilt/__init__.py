"""The direction of height."""
