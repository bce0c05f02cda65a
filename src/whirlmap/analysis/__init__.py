"""What a motion is: steady states, labels, exponents, spectra, dimensions. Runs over grids of parameters are in `sweep`."""
