"""Machines that are described by their parts: reading them, reducing their shafts, and assembling the `Model`.

What belongs here: tables of a case file with ``model = "machine"``, matrices of shafts, their modes, and one file for each
part. What does not: anything that is computed of a motion. The derivation is docs/parts.md.
"""
