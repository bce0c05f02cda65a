"""Grids and random draws computed chunk by chunk, by threads or a cluster. The files of a store are in `sweep.store`."""
