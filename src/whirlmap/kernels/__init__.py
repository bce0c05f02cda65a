"""Models as machine code: lowering, generated modules, the cache, and the plain NumPy oracle."""
