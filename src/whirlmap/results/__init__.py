"""What computations return: labelled Datasets, their statuses and where they come from."""
