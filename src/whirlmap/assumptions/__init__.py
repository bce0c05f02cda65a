"""What the models of machines assume, and where a system or its results leave that: `strained.strained` decides it."""
