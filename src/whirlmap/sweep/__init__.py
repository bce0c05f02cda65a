"""Many operating points: diagrams, maps, attractors, safe speeds. The measurement of one point is in `analysis`."""
