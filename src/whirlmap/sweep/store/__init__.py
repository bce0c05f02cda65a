"""A sweep on disk: a Zarr group in which every chunk is committed whole. What is computed is decided in `maps`."""
