"""The search for steady motion: transients, returns of the section, numbers of steps. Labels are in `labels`."""
