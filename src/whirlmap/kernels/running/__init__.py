"""Compiled kernels as Python calls them, and the plain NumPy reference of the equations."""
