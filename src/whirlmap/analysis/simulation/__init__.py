"""Time series and sections of one operating point, as a person looks at them. Searches for steady states are in `steady`."""
