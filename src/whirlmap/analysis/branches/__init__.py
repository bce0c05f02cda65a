"""Branches of periodic orbits and equilibria, stable or not, and where they bifurcate: no labels, no files."""
