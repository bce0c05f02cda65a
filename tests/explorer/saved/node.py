"""The page's own code, run by node: motions as lists of numbers."""

import json
import shutil
import subprocess
from importlib.resources import files

import numpy as np
import pytest

from whirlmap.explorer.saved.live_points import live_points
from whirlmap.explorer.saved.packing import text_of
from whirlmap.sweep.parameters.space import space_of

needs_node = pytest.mark.skipif(shutil.which("node") is None, reason="node is not installed")

SCRIPT = """
const { unpack, Live } = require(process.argv[1]);
(async () => {
  const job = JSON.parse(require("fs").readFileSync(0));
  const out = [];
  for (const { description, data, at, options } of job) {
    const live = new Live(description, await unpack(data)), motion = await live.motion(at, options);
    out.push({ ...motion, turn: [...motion.turn], x: [...motion.x], outputs: [...motion.outputs] });
  }
  process.stdout.write(JSON.stringify(out));
})().catch((error) => { console.error(error); process.exit(1); });
"""


def motions(jobs):
    """Run `live.motion` for (system, vary, at, options, packed...); returns dicts with arrays (sample, row)."""
    asked = []
    for system, vary, at, options, *packed in jobs:
        description, data = live_points(system, space_of(system, vary), **(packed[0] if packed else {}))
        asked.append({"description": description, "data": text_of(data), "at": at, "options": options})
    script = str(files("whirlmap.explorer.saved") / "live_motion.js")
    ran = subprocess.run(
        ["node", "-e", SCRIPT, script], input=json.dumps(asked), capture_output=True, text=True, check=False
    )
    assert ran.returncode == 0, ran.stderr
    found = json.loads(ran.stdout)
    for one, job in zip(found, jobs, strict=True):
        rows = len(one["turn"])
        one["turn"] = np.array(one["turn"])
        one["x"] = np.array(one["x"], dtype=float).reshape(rows, job[0].model.dimension)
        one["outputs"] = np.array(one["outputs"], dtype=float).reshape(rows, -1)
    return found
