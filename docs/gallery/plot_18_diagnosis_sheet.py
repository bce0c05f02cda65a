"""
One operating point on one sheet
================================

The diagnosis of Duffing's oscillator in chaos: every indicator votes, and the sheet shows what they voted on.

**What to look at:** the label, its confidence, and whether the indicators agree.
"""

import json

import whirlmap

system = whirlmap.load("duffing")  # gamma = 0.5
verdict = whirlmap.diagnose(system)
figure = whirlmap.plot.diagnosis_figure(verdict, "x")

for name, vote in json.loads(verdict.attrs["indicators"]).items():
    print(f"{name:24} {vote.get('vote')}")
