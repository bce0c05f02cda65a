"""The command line: each command parses, calls the library and reports; none computes."""
