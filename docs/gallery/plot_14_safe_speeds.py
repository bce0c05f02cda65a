"""
Safe speeds of a test rig
=========================

At which speeds may the rig run if its journals and its disc may move by 60 micrometres? Every speed is judged
from a cold start, in run-up and in run-down.

**What to look at:** the green windows, and the reason that ends each: the amplitude near the critical speed
of 2970 rpm; and, far above it, a second motion, oil whip, that coexists with the small one and that a
run-down meets before a run-up does.
"""

import numpy as np

import whirlmap

system = whirlmap.load("machines/jeffcott-rig")
per_rpm = system.values["s"] / 1800  # the case is given at 1800 rpm
found = whirlmap.safe_speeds(system, np.linspace(600, 6900, 22) * per_rpm, "60 um")
figure = whirlmap.plot.speeds_figure(found)

# %%
# Windows of safe speeds, in rpm:

for n in range(found.sizes["window"]):
    one = found.isel(window=n)
    print(f"{one['window_start'].item() / per_rpm:6.0f} to {one['window_end'].item() / per_rpm:6.0f} rpm")
