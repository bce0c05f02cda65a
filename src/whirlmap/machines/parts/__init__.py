"""Parts of a machine, one file each: what it may say, its unknowns, its force at stations, its own rates, its outputs."""
