"""What figures and panels share: style, names of axes, limits, saving."""
