"""What a motion is: sections, returns, spectra, exponents, dimensions."""
