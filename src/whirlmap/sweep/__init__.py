"""Many operating points: ranges and diagrams."""
