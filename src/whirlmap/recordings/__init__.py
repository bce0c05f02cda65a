"""Recorded signals in files: what a file holds, its clock, and one column of it as an evenly spaced signal."""
