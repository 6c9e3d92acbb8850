"""Level sets: contours, regions, pieces and blocks."""
