"""Results of computations: labelled Datasets, their statuses and their provenance."""
