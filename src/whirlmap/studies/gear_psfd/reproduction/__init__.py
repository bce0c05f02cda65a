"""Figures 2 to 7 and a verdict on every statement: what `reproduce` computes and writes."""
