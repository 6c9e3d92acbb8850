"""Descriptors of a model, numbers that tell shapes apart however they stand, and the distance between models by them."""
