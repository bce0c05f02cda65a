"""The two kinds of options that every analysis and sweep takes: what is computed, and how it is run."""
