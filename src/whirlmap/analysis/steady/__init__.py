"""The steady-state search: transients, returns of the section, numbers of steps. Labels are in `labels`."""
