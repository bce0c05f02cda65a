"""Linear analysis about the static equilibrium: eigenvalues, Campbell diagram, film coefficients, stability threshold."""
