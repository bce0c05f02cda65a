"""whirlmap: labelled regime maps for geared rotors on fluid films."""

__version__ = "0.1.0"
