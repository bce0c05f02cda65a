"""Power spectra, their lines, and the names of the lines."""
