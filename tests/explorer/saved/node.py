"""The code of a saved page, run by node: what it computes as arrays."""

import json
import shutil
import subprocess
from importlib.resources import files

import numpy as np
import pytest

from whirlmap.explorer.encoding import json_text
from whirlmap.explorer.saved.live_points import live_points
from whirlmap.explorer.saved.packing import text_of
from whirlmap.explorer.saved.saved_page import saved_data
from whirlmap.sweep.parameters.space import space_of

needs_node = pytest.mark.skipif(shutil.which("node") is None, reason="these tests need node: apt-get install nodejs")

PLACE = files("whirlmap.explorer.saved")
BEGIN = f"""
const parts = {{
  whirlmapHarmonics: "harmonics", whirlmapLive: "live_motion", whirlmapSpectrum: "spectrum", whirlmapSaved: "saved",
}};
for (const [name, file] of Object.entries(parts)) globalThis[name] = require({json.dumps(str(PLACE))} + "/" + file + ".js");
const plain = (value) => ArrayBuffer.isView(value) ? [...value] : Array.isArray(value) ? value.map(plain)
  : value && typeof value === "object" ? Object.fromEntries(Object.entries(value).map(([k, v]) => [k, plain(v)])) : value;
const job = JSON.parse(require("fs").readFileSync(0));
(async () => process.stdout.write(JSON.stringify(plain(await work(job)))))()
  .catch((error) => {{ console.error(error); process.exit(1); }});
"""


def ran(work, job):
    """Result of the JavaScript function ``work(job)``."""
    done = subprocess.run(
        ["node", "-e", f"{work}\n{BEGIN}"], input=json.dumps(job), capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def motions(jobs):
    """Run `live.motion` for (system, vary, at, options, packed...); returns dicts with arrays (sample, row)."""
    asked = []
    for system, vary, at, options, *packed in jobs:
        description, data = live_points(system, space_of(system, vary), **(packed[0] if packed else {}))
        asked.append({"description": description, "data": text_of(data), "at": at, "options": options})
    found = ran(
        """const work = async (jobs) => {
             const out = [];
             for (const { description, data, at, options } of jobs)
               out.push(await new whirlmapLive.Live(description, await whirlmapLive.unpack(data)).motion(at, options));
             return out;
           };""",
        asked,
    )
    for one, job in zip(found, jobs, strict=True):
        rows = len(one["turn"])
        one["turn"] = np.array(one["turn"])
        one["x"] = np.array(one["x"], dtype=float).reshape(rows, job[0].model.dimension)
        one["outputs"] = np.array(one["outputs"], dtype=float).reshape(rows, -1)
    return found


def shown(exploration, points, quantity):
    """What a saved page shows at points, and what it computed for that."""
    data, packed = saved_data(exploration)
    job = {"data": text_of(json_text(data).encode()), "bytes": text_of(packed), "points": points, "quantity": quantity}
    return ran(
        """const work = async ({ data, bytes, points, quantity }) => {
             const source = whirlmapSaved.source({ data, bytes }), out = [];
             await source.load();
             for (const at of points)
               out.push({ ...(await source.motion(at, quantity)), computed: await source.computed(at) });
             return out;
           };""",
        job,
    ), data
