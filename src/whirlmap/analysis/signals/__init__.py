"""Recorded signals: diagnosis, steadiness, lines, embedding, exponents. Reading files is the work of `recordings`."""
