"""Source of every generated kernel module that reads tables.

This file is never imported. `source.py` copies it into the module, which defines ``L`` (lanes). A table is laid out by
`tabulate.entries`: the number of cells along each coordinate, their inner edges, and one record for each cell.
"""
# ruff: noqa: F821
# mypy: ignore-errors


@inner
def fetch(tables, table, axes, record, scratch, row, l):
    """Copy the record of the cell that lane l is in behind its coordinates, which stand from ``row`` on.

    A coordinate outside of the table gets the outermost cell, one that is not a number the first.
    """
    at = table + axes
    cell = 0
    for axis in range(axes):
        z = scratch[(row + axis) * L + l]
        edges = int(tables[table + axis]) - 1
        i = 0
        for j in range(edges):
            i += 1 if tables[at + j] <= z else 0
        cell = cell * (edges + 1) + i
        at += edges
    at += cell * record
    for k in range(record):
        scratch[(row + axes + k) * L + l] = tables[at + k]
