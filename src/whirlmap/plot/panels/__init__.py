"""Single panels: a Dataset in, the Axes out."""
