"""Recorded signals in files: format, columns, sampling times, and one column as an evenly spaced signal."""
