"""Numbers read from sequences of points: 0-1 test, averages, recurrence, dimension. No equations are needed here."""
