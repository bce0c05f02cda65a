"""The explorer as one file that needs no server: the data, the kernels for the browser, and the page around them."""
