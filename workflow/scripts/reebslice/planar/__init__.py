"""Closed curves and regions of the plane."""
