"""Diagnosis of recorded signals: steadiness, lines on a common grid, returns."""
