"""LLVM routines: rates, steps, crossings of surfaces, extremes. What is compiled and called is in `running`."""
