"""Runs of many operating points: ensembles, crossings of a section, extremes, lengths. Labels are in `labels`."""
