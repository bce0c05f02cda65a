"""The points of a sweep: ranges, random draws within tolerances, and grids made of them."""
