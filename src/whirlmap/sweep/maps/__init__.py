"""Grids and random draws computed chunk by chunk, by threads or a cluster. What lies on the disk is the work of `store`."""
