"""The rule that labels operating points, and the runs that it requires. Single indicators are in `indicators`."""
