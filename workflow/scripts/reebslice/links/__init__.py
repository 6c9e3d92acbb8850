"""Links between levels from shapes alone: similarity and proximity."""
