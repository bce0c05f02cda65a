"""Many start states of one operating point: coexisting attractors and their basins."""
