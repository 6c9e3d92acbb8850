"""Material points, arcs, and the Reeb graphs of solid and surface."""
