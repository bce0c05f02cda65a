"""Systems in time: start states, ensembles of lanes, events."""
