/* The explorer's page: a map or a diagram, and beside it the motion of the chosen point.

   The page needs two things, and knows nothing else of where it runs:

   explorer.data, one JSON object (`whirlmap.explorer.overview.page_data`):
     title, case, kind ("map", "diagram" or "point"), forced
     controls   [{name, symbol, meaning, value, low, high, log, unit, size, axis}]: quantities that can be changed; a value
                is in the model's own numbers, what is written is value * size in unit; axes of the map come first. A source
                that has motions of some values alone gives them as `points`, ascending: no other value is chosen.
                Switches come last, {name, symbol, meaning, value, choices, axis: false}: a value is one of the words
     overview   {axes: [{name, values}], regime, period, numbers: {name: {label, unit, values}}, section: {way: {state:
                values}}, units: {state: unit}}: first axis slowest; regime 255 where a point has none; way is "" , "up" or
                "down"; section values are over points and T; incomplete: how many points are computed, "" where all are
     states, outputs  [{name, symbol, meaning}];  swing [names];  velocities {name: name};  clocks {name: turns per T}
     planes     [{name, x, y, equal, clearance}];  films [{bearing, eccentricity, load}]
     regimes    [{code, name, label}];  branches [{kind, values: {axis: values}, branch, stable, section, events}]
     filling    number of the job that computes the overview just now, if any;  grows  whether a reload may find more points
   Arrays are {type, shape, data}: base64 of f8, f4, i4, i1 or u1, little-endian; `explorer.array` decodes them.

   explorer.source, an object of functions that give promises:
     load()                  the data, where `explorer.data` is not set yet
     motion(values, quantity, signal)   the motion at values {name: number}, those that differ from the case's:
       {turn, time, time_unit, series: {name: array}, units: {name: unit}, section: {state: array},
        spectrum: null or {quantity, frequency, power, lines: [{frequency, share, name}], broadband},
        label: {regime, name, text, period, decided, status, ...}, numbers: [{name, of, value, unit}]}
       turn and time begin at 0; section has a point per T (of unforced motion: per crossing); frequencies are in 1/T.
       Arrays may be encoded, or typed arrays already.
   and, where there are such, else their buttons are hidden:
     votes(values), finer({values, ranges, count}), coexisting(values, along, quantity), branches(values): start a job; the result
     of the last is a list, as data.branches;
     job(number, version) its report {job, done, total, running, error, version, result?}; cancel(number);
     export(kind, values) gives text;  state() gives {compiling}.
*/
"use strict";
const explorer = {
  data: null, source: null, shown: null, others: {}, layers: [], branches: [],
  state: {values: {}, quantity: "", plane: 0, colour: "regime", section: "", zoom: null, auto: true, autoVotes: false},
  listeners: [], moved: "",
};

explorer.types = {f8: Float64Array, f4: Float32Array, i4: Int32Array, i1: Int8Array, u1: Uint8Array};

/** Decode an array; what is one already stays. */
explorer.array = (value) => {
  if (!value || ArrayBuffer.isView(value)) return value;
  const text = atob(value.data), bytes = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) bytes[i] = text.charCodeAt(i);
  const found = new explorer.types[value.type](bytes.buffer);
  found.shape = value.shape;
  return found;
};

/** Decode all arrays of an object by name. */
explorer.arrays = (named) => Object.fromEntries(Object.entries(named || {}).map(([k, v]) => [k, explorer.array(v)]));

/** Values of which there are motions: the nearest points, where a quantity has such; `explorer.moved` says what they replace. */
explorer.nearest = (values) => {
  const out = {...values}, said = [];
  for (const [name, v] of Object.entries(values)) {
    const c = explorer.control(name), points = c.points;
    if (!points?.length || points.includes(v)) continue;
    out[name] = points.reduce((best, p) => (Math.abs(p - v) < Math.abs(best - v) ? p : best));
    const beyond = v < points[0] || v > points[points.length - 1], text = (x) => `${c.symbol} = ${explorer.withUnit(x * c.size, c.unit, 6)}`;
    said.push(`${text(v)} lies ${beyond ? "beyond" : "between"} the points of this file: shown is the nearest of them, ${text(out[name])}`);
  }
  explorer.moved = said.join("; ");
  return out;
};

/** Change the state, and tell those who listen which of its parts changed. */
explorer.set = (patch) => {
  if (patch.values) {
    patch = {...patch, values: explorer.nearest(patch.values)};
    if (explorer.moved) explorer.say(explorer.moved); // also where this is the point that is shown already
  }
  const changed = Object.keys(patch).filter((k) => JSON.stringify(explorer.state[k]) !== JSON.stringify(patch[k]));
  if (!changed.length) return;
  Object.assign(explorer.state, patch);
  for (const listen of explorer.listeners) listen(new Set(changed));
};

explorer.$ = (id) => document.getElementById(id);

/** An element with a text and attributes. */
explorer.make = (tag, text = "", attributes = {}) => {
  const e = document.createElement(tag);
  e.textContent = text;
  for (const [k, v] of Object.entries(attributes)) e.setAttribute(k, v);
  return e;
};

/** A number in a few digits. */
explorer.digits = (v, n = 4) => {
  if (v === null || v === undefined || !Number.isFinite(v)) return "–";
  if (v !== 0 && (Math.abs(v) < 1e-3 || Math.abs(v) >= 1e6)) return v.toExponential(n - 2).replace(/\.?0*e\+?/, "e").replaceAll("-", "−");
  return String(+v.toPrecision(n)).replace("-", "−");
};
explorer.unit = (unit) => (unit && unit !== "1" ? ` ${unit.replace("um", "µm")}` : "");
explorer.withUnit = (v, unit, n) => explorer.digits(v, n) + explorer.unit(unit);

explorer.control = (name) => explorer.data.controls.find((c) => c.name === name);
/** The value of a quantity now, in the model's own numbers. */
explorer.value = (name) => explorer.state.values[name] ?? explorer.control(name).value;
explorer.quantityOf = (name) => [...explorer.data.states, ...explorer.data.outputs].find((q) => q.name === name);
explorer.axisLabel = (symbol, unit) => (unit && unit !== "1" ? `${symbol} [${unit.replace("um", "µm")}]` : symbol);

/** Change values of quantities: those of the case are not kept. */
explorer.change = (values) => {
  const all = {...explorer.state.values, ...values};
  for (const [k, v] of Object.entries(all)) {
    const c = explorer.control(k);
    if (!c.axis && v === c.value) delete all[k];
  }
  explorer.set({values: all});
};

/** Text that `record` may be told by a test: what is drawn now. */
explorer.regime = (code) => explorer.data.regimes.find((r) => r.code === code);
