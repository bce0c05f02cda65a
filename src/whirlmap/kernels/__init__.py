"""Models as machine code: `lowering` to straight-line code, `writing` LLVM routines, `running` them; methods; the cache."""
