"""Speed against accuracy, measured beside other integrators in one run; every peer is optional."""
