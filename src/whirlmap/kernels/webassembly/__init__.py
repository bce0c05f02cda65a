"""The kernels as WebAssembly modules, for a browser: the same assembly, compiled for another target."""
