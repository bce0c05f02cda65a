"""Which points a sweep has: ranges, random draws within tolerances, and the grids made of them."""
