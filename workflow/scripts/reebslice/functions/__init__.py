"""Functions on a surface besides the height: one value for each vertex, the same wherever the model stands."""
