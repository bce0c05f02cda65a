"""Spectra, their lines and the names of these."""
