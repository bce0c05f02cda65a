"""
Lorenz and Rössler: exponents and dimensions of flows
=====================================================

Two systems without forcing, whose exponents are known from many sources: 0.906, 0, -14.57 for the Lorenz
system (:cite:t:`lorenz1963`) and 0.071, 0, -5.39 for Rössler's (:cite:t:`roessler1976`).

**What to look at:** the exponents with their errors; one of them is zero for every unforced flow that is not
at rest.
"""

import whirlmap

lorenz = whirlmap.load("lorenz")
for name in ("lorenz", "roessler"):
    found = whirlmap.lyapunov_spectrum(whirlmap.load(name), common_periods=400)
    print(
        name, *(f"{e:.4f} +- {d:.4f}" for e, d in zip(found["lyapunov"].values, found["lyapunov_error"].values, strict=True))
    )

# %%
# The butterfly.

butterfly = whirlmap.plot.draw_phase_portrait(whirlmap.simulate(lorenz, transient=50, periods=60), "x", "z")
