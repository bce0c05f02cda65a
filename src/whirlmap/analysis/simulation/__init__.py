"""Time series and sections of one operating point. Searches for steady states are in `steady`."""
