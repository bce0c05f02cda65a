"""Tangent dynamics: Lyapunov exponents, Floquet multipliers, the dimension that exponents give."""
