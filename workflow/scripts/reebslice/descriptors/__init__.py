"""Descriptors of a model, numbers that tell shapes apart however they stand, and distances between models by them."""
