"""Film laws: reference evaluation, scaled tables, linear coefficients, and laws as expressions."""
