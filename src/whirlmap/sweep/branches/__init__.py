"""Branches of a case against its parameters: where they begin, their Datasets, and what is read from them."""
