"""From a model's expressions to straight-line code: normal forms, derivatives, tables, surfaces. LLVM is in `writing`."""
