"""Triangle meshes: inspection, repairs, shells and measures."""
