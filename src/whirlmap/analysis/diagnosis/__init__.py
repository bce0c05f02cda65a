"""Diagnosis of one operating point from one set of runs. The rule that labels it is in `labels`."""
