"""One module for each command: it calls the library and reports. Its options are in `whirlmap.cli.declared`."""
