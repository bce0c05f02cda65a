"""The rule that labels operating points, and the runs that it asks for. Single indicators are in `indicators`."""
