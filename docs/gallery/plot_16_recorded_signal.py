"""
A recorded signal: regular or chaotic?
======================================

A signal has no equations. Here it is one state of Rössler's system with 0.2 % of noise, so that the right
answer is known: chaotic, with the largest exponent 0.071 per unit of time (:cite:t:`roessler1976`).

**What to look at:** the spectrum has a broad floor beside its lines, neighbours in the delay embedding
diverge exponentially, and the slope of that divergence is the exponent.
"""

import numpy as np

import whirlmap

system = whirlmap.load("roessler")
series = whirlmap.simulate(system, transient=200, periods=400, every=4)
x = series["x"].sel(state="x").values
rate = 1 / float(series["time"][1] - series["time"][0])
noisy = x + 0.002 * x.std() * np.random.default_rng(1).normal(size=x.size)

verdict = whirlmap.diagnose_series(noisy, rate=rate, unit="1")
figure = whirlmap.plot.series_figure(verdict)
print(whirlmap.labels(verdict).item())
print(verdict.attrs["verdict"])
