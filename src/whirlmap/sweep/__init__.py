"""Many operating points: diagrams, maps, attractors, safe speeds. What is measured of one point is decided in `analysis`."""
