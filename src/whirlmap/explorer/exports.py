"""What leaves the explorer: the script and the commands that compute a motion again, and its data."""

import json
import shlex
from typing import Any

from whirlmap.explorer.control import Values, changes_of
from whirlmap.explorer.exploration import Exploration
from whirlmap.explorer.motion import Motion
from whirlmap.options.computed import Settling

SCRIPT = '''"""The motion of {case} at {at}: settled, recorded, and labelled with all indicators."""

import whirlmap

system = whirlmap.load({case!r}{changes})
point = whirlmap.label_points(
    system, {{{name!r}: [{value!r}]}}, ends=True, lyapunov=0{labelling},
)
{begin}
series = whirlmap.simulate(system{start}, periods={periods}, steps={steps}{method})

if __name__ == "__main__":
    print(whirlmap.labels(point).values, "period in T:", point["period_T"].values)
    print(series)
    print(whirlmap.diagnose(system))  # exponents, multipliers, and the vote of every indicator
'''


def all_changes(exploration: Exploration, values: Values) -> dict[str, Any]:
    """Changes of the case by which its system, at these values, is loaded."""
    system = exploration.system
    given = dict(system.machine.changes) if system.machine else {}
    return given | changes_of(system, exploration.controls, values)


def script(exploration: Exploration, values: Values, m: Motion) -> str:
    """A script that computes this motion again, to the bit."""
    system, labelling = m.system, exploration.labelling
    given = all_changes(exploration, values)
    words = all(name.isidentifier() for name in given)  # names of parts have points: shaft.rotor.m
    changes = "".join(f", {name}={value!r}" for name, value in given.items()) if words else f", **{given!r}"
    if exploration.system.start:
        changes += f", start={dict(exploration.system.start)!r}"
    usual, s, options = Settling(), labelling.settling, ""
    for name in ("transient", "most", "tolerance"):
        if getattr(s, name) != getattr(usual, name):
            options += f", {name}={getattr(s, name)!r}"
    method = f", method={labelling.integration.method!r}" if labelling.integration.method else ""
    accuracy = f", accuracy={labelling.integration.accuracy!r}" if labelling.integration.accuracy else ""
    settled = set(m.recipe.start) == set(system.states)
    begin = 'end = dict(zip(system.states, point["end_state"].values[0].tolist()))' if settled else "# the run ends"
    at = ", ".join(f"{name} = {value if isinstance(value, str) else f'{value:g}'}" for name, value in values.items())
    return SCRIPT.format(
        case=exploration.system.case, at=at or "the values of the case",
        changes=changes, name=system.parameters[0], value=float(system.vector[0]), labelling=options + method + accuracy,
        begin=begin, start=".replace(start=end)" if settled else "", periods=m.recipe.periods, steps=m.recipe.steps,
        method=method,
    )  # fmt: skip


def commands(exploration: Exploration, values: Values) -> list[str]:
    """Commands for this point, and the one that made the map or diagram."""
    sets: list[str] = []
    for name, value in all_changes(exploration, values).items():
        sets += ["--set", f"{name}={value}"]
    starts = [word for name, value in exploration.system.start.items() for word in ("--start", f"{name}={value!r}")]
    place = [exploration.system.case, *sets, *starts]
    found = [shlex.join(["whirlmap", "diagnose", *place]), shlex.join(["whirlmap", "simulate", *place])]
    made = "" if exploration.overview is None else str(exploration.overview.attrs.get("command", ""))
    return [*found, made] if made.startswith("whirlmap ") else found  # a result of Python names its script


def data_csv(m: Motion) -> str:
    """The recorded series as text: time, turn, states and outputs in the model's own units, with all digits."""
    ds = m.series
    names = ["time", "turn", *m.system.states, *m.system.model.outputs]
    rows = zip(
        ds["time"].values.tolist(), ds["turn"].values.tolist(), ds["x"].values.tolist(), ds["outputs"].values.tolist(),
        strict=True,
    )  # fmt: skip
    head = f"# {json.dumps({'case': m.system.case, 'model': m.system.model.name, 'parameters': _numbers(m)})}"
    return "\n".join([head, ",".join(names), *(",".join(map(repr, (t, n, *x, *o))) for t, n, x, o in rows)]) + "\n"


def _numbers(m: Motion) -> dict[str, Any]:
    return {name: float(value) for name, value in m.system.values.items()}
