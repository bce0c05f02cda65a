"""Periodic orbits: found by Newton's method, and which runs converge to them. Their multipliers are in `variational`."""
