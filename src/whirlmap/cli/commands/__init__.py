"""One module for each command: it declares the options, calls the library and reports."""
