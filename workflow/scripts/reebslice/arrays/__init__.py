"""Components, sorting and grouping of arrays."""
