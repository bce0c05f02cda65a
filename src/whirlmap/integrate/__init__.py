"""Integration in time: systems, start states, ensembles of lanes, terminal events."""
