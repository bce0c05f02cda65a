"""Periodic orbits: closed by Newton's method, and which runs arrive at them. Their multipliers are in `variational`."""
