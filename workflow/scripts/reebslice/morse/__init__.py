"""The height as a Morse function: order, critical points, exact Reeb graph of the surface."""
