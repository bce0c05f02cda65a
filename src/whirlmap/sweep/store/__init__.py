"""A sweep on disk: a Zarr group in which every chunk is committed whole. The computation is in `maps`."""
