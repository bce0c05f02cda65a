// Where a saved page's data and motions come from: from itself. What whirlmap.explorer.saved.saved_page wrote into it is
//   data    the page's data; `note`, what it cannot do of what such a file can, if anything; `limits`, what needs the
//           server; `record`: how motions are recorded; and `live`, the description of live points, or `stored`, motions
//           that were computed before
//   bytes   what the live points or the stored motions are made of
"use strict";

const whirlmapSaved = (() => {
  // T between two looks whether a motion has returned; T that one is waited for beyond what the diagram or map says, and
  // longest return that is looked for where nothing is known.
  const LOOK = 8, LATE = 512, LONGEST = 64;
  // Steps in which a state is carried to a point, and the part of the axis that it comes along (coexisting.py).
  const STEPS = 8, REACH = 0.2;
  // Samples that are recorded in one piece; that are shown, and least of these in a T; turns of the slowest clock that are
  // shown; least samples per T of a spectrum.
  const PIECE = 16384, SAMPLES = 2400, LEAST = 12, TURNS = 4, RATE = 48;

  // --- live motions -----------------------------------------------------------------------------------------------------

  // Runs a live point: its states at the end of each T, their ranges, and all samples where these are kept.
  class Run {
    constructor(point, states) {
      Object.assign(this, { point, states, ends: [], pieces: [] });
    }

    async go(periods, kept = false) {
      const { point, states } = this, low = Array(states).fill(Infinity), high = Array(states).fill(-Infinity);
      const most = Math.max(Math.floor(PIECE / point.steps), 1);
      for (let left = periods; left > 0 && !point.ended; left -= most) {
        const begun = point.done, x = await point.advance(Math.min(left, most) * point.steps, 1), samples = point.done - begun;
        for (let k = 0; k < samples; k++) {
          for (let i = 0; i < states; i++) {
            low[i] = Math.min(low[i], x[k * states + i]);
            high[i] = Math.max(high[i], x[k * states + i]);
          }
          if ((k + 1) % point.steps === 0) this.ends.push(x.slice(k * states, (k + 1) * states));
        }
        if (kept) this.pieces.push(x.subarray(0, samples * states));
        this.tell?.(point.done / point.steps);
      }
      this.range = low.map((v, i) => high[i] - v);
    }

    // Whether the states return after n T, over the last n of them, to a part of each range.
    returns(n, tolerance) {
      const last = this.ends.length - 1;
      if (last < 2 * n) return false;
      const floor = 1e-6 * Math.max(...this.range);
      for (let k = last - n + 1; k <= last; k++) {
        for (let i = 0; i < this.states; i++) {
          if (Math.abs(this.ends[k][i] - this.ends[k - n][i]) > tolerance * Math.max(this.range[i], floor)) return false;
        }
      }
      return true;
    }

    // Go on until the motion returns after as many T as the diagram or map says, or for as long as it ran there.
    async settle([period, waits], { tolerance, common }) {
      const counts = Array.from({ length: LONGEST }, (_, k) => k + 1), shared = counts.map((k) => k * Math.max(common, 1));
      const known = period > 0 ? [period] : period < 0 ? [...new Set([...counts, ...shared])].sort((a, b) => a - b) : [];
      const limit = known.length ? waits + LATE : waits, look = known.length ? Math.max(LOOK, 2 * period) : waits;
      for (;;) {
        const n = known.find((k) => this.returns(k, tolerance)) || 0, left = limit - this.point.done / this.point.steps;
        if (n || left <= 0 || this.point.ended) return n;
        await this.go(Math.min(look, left));
      }
    }
  }

  // A motion at the live point nearest to values, or at an index, from a state that is carried there: settled and recorded.
  async function liveMotion(live, data, values, { at = live.nearest(values), from = null, tell = null } = {}) {
    const index = at, { point, run, period } = await settled(live, data, index, from, tell), states = data.live.states.length;
    const settledAfter = point.done / point.steps, ended = point.ended;
    if (ended) { point.restart(); if (from) point.begin(from); }
    const begin = Float64Array.from(point.x.slice(0, states));
    if (!ended) await run.go(Math.max(data.record.periods, 2 * period), true);
    else run.pieces.push(await point.advance(Math.floor(ended.turn * point.steps), 1));
    const x = new Float64Array(run.pieces.reduce((size, piece) => size + piece.length, states));
    x.set(begin);
    run.pieces.reduce((at, piece) => { x.set(piece, at); return at + piece.length; }, states);
    const plane = data.live.section ? live.take(data.live.section, index) : null;
    return {
      values: live.values(index), x, outputs: await point.outputs(x), steps: point.steps, time: point.period, period,
      settled: settledAfter, ended: ended || point.ended, plane, sizes: live.take(data.live.sizes, index),
    };
  }

  // A run that goes on until its motion returns. A carried state may come to another motion than the map says: any return counts.
  async function settled(live, data, index, from, tell = null) {
    const point = live.point(index), run = new Run(point, data.live.states.length), [n, waits] = live.take(data.live.settling, index);
    run.tell = tell;
    if (from) point.begin(from);
    return { point, run, period: await run.settle([from && n > 0 ? -1 : n, waits], data.record) };
  }

  // So many T later all forcing is at phase zero, after -n T.
  const whole = (n, common) => (common > 1 ? ((Math.round(n) % common) + common) % common : 0);

  // Motions that come to a point along an axis, from below and from above; null where a run ends on the way.
  async function coexisting(live, data, values, along) {
    const index = live.nearest(values), axis = data.live.axes.findIndex((a) => a.name === along), last = data.live.axes[axis].values.length - 1;
    const found = {};
    for (const [way, sign] of [["up", -1], ["down", 1]]) {
      const far = Math.min(Math.max(index[axis] + sign * Math.max(Math.round(REACH * last), 1), 0), last), path = new Set();
      for (let k = 0; k < STEPS; k++) path.add(Math.round(far + (index[axis] - far) * k / STEPS));
      path.delete(index[axis]);
      let from = null, ended = false;
      for (const place of path) {
        const at = index.map((i, k) => (k === axis ? place : i)), { point } = await settled(live, data, at, from);
        if (!point.ended) await point.advance(point.steps * whole(-point.done / point.steps, data.record.common)); // to phase zero
        ended = ended || Boolean(point.ended);
        if (ended) break;
        from = Array.from(point.x.slice(0, data.live.states.length));
      }
      found[way] = ended ? null : await liveMotion(live, data, values, { at: index, from });
    }
    return found;
  }

  // --- stored motions -----------------------------------------------------------------------------------------------------

  // The stored motion nearest to values, each axis over its range.
  function storedMotion(data, buffer, values) {
    const { axes, motions, states, outputs } = data.stored;
    const away = (m) => Math.hypot(...axes.map(({ name, low, high }) => (m.values[name] - values[name]) / (high - low || 1)));
    const m = motions.reduce((best, one) => (away(one) < away(best) ? one : best));
    const numbers = new Float32Array(buffer, m.at, m.samples * (states.length + outputs.length));
    return {
      ...m, x: Float64Array.from(numbers.subarray(0, m.samples * states.length)),
      outputs: Float64Array.from(numbers.subarray(m.samples * states.length)), plane: null,
    };
  }

  // --- what the page shows --------------------------------------------------------------------------------------------------

  // Crossings of a plane in one direction, by the cubic through four samples; its last number is the constant.
  function crossings(x, states, plane, rising) {
    const height = (k) => {
      let g = plane[states];
      for (let i = 0; i < states; i++) g += plane[i] * x[k * states + i];
      return rising ? g : -g;
    };
    const out = [];
    for (let k = 1; k + 2 < x.length / states; k++) {
      if (!(height(k) < 0 && height(k + 1) >= 0)) continue;
      const weights = (u) => [-u * (u - 1) * (u - 2) / 6, (u * u - 1) * (u - 2) / 2, -u * (u + 1) * (u - 2) / 2, u * (u * u - 1) / 6];
      const four = [-1, 0, 1, 2].map((d) => height(k + d)), at = (u) => weights(u).reduce((sum, w, j) => sum + w * four[j], 0);
      let low = 0, high = 1;
      for (let j = 0; j < 50; j++) { const middle = (low + high) / 2; if (at(middle) < 0) low = middle; else high = middle; }
      const w = weights(high);
      out.push(Array.from({ length: states }, (_, i) => w.reduce((sum, v, j) => sum + v * x[(k - 1 + j) * states + i], 0)));
    }
    return out;
  }

  function columns(m, names) {
    const rows = m.x.length / names.states.length, out = {};
    names.states.forEach((name, i) => { out[name] = Float64Array.from({ length: rows }, (_, k) => m.x[k * names.states.length + i] * m.sizes[i]); });
    names.outputs.forEach((name, i) => {
      const size = m.sizes[names.states.length + i];
      out[name] = Float64Array.from({ length: rows }, (_, k) => m.outputs[k * names.outputs.length + i] * size);
    });
    return out;
  }

  const ends = (values) => {
    let low = Infinity, high = -Infinity;
    for (const v of values) { if (v < low) low = v; if (v > high) high = v; }
    return [low, high];
  };

  // A motion as the page takes it (see explorer.js).
  function described(m, data, asked, quantity) {
    const names = data.live || data.stored, states = names.states.length, page = data.page, record = data.record;
    const all = columns(m, names), rows = m.x.length / states, steps = m.steps;
    const turns = m.period ? m.period * Math.max(1, Math.ceil((TURNS * record.turn) / m.period)) : 4 * TURNS * record.turn;
    const least = Math.min((m.period || record.turn) * steps, rows - 1); // where these do not fit, a part of the samples is shown
    const parts = Array.from({ length: Math.max(Math.floor(steps / LEAST), 1) }, (_, k) => k + 1).filter((k) => steps % k === 0);
    const take = m.ended ? 1 : parts.find((k) => least <= SAMPLES * k) || parts[parts.length - 1];
    const last = Math.floor(Math.min(m.ended ? rows - 1 : Math.round(turns * steps), rows - 1, SAMPLES * take) / take) + 1;
    const samples = Array.from({ length: last }, (_, k) => k * take), section = {};
    const part = (values) => Float64Array.from(samples, (k) => values[rows - 1 - samples[last - 1] + k]);
    if (page.forced) {
      const count = Math.floor((rows - 1) / steps);
      names.states.forEach((name) => { section[name] = Float64Array.from({ length: count }, (_, k) => all[name][(k + 1) * steps]); });
    } else if (m.plane && !m.ended) {
      const found = crossings(m.x, states, m.plane, names.rising);
      names.states.forEach((name, i) => { section[name] = Float64Array.from(found, (x) => x[i] * m.sizes[i]); });
    }
    let series = all[quantity].subarray(1);
    if (record.cyclic[quantity]) series = series.map((v) => Math.sin((2 * Math.PI * v) / record.cyclic[quantity]));
    let every = 1; // a part of the samples shows all lines that the panel has room for
    for (let k = 2; k * RATE <= steps; k++) if (steps % k === 0) every = k;
    if (every > 1) series = Float64Array.from({ length: Math.floor(series.length / every) }, (_, k) => series[(k + 1) * every - 1]);
    const spectrum = m.ended ? null : whirlmapSpectrum.spectrum(series, steps / every, page.clocks);
    // In a unit a displacement is not over the clearance, as the model's own number is.
    const meaning = (name) => page.states.find((q) => q.name === name).meaning.split(names.units[name] === "1" ? "\n" : ", over ")[0];
    const numbers = page.swing.map((name) => {
      const [low, high] = ends(all[name]);
      return { name: `peak to peak of ${meaning(name)}`, of: name, value: high - low, unit: names.units[name] };
    });
    for (const film of page.films) {
      for (const [what, name] of [["largest eccentricity", film.eccentricity], ["largest load", film.load]]) {
        if (name) numbers.push({ name: `${what}, bearing ${film.bearing}`, of: "", value: ends(all[name])[1], unit: names.units[name] });
      }
    }
    for (const c of page.controls) { // the page asks for points that there are; another caller may not
      if (c.axis && m.values[c.name] !== asked[c.name]) numbers.push({ name: `shown is the motion at ${c.symbol}`, of: "", value: m.values[c.name] * c.size, unit: c.unit });
    }
    const text = m.ended ? `the run ends after ${m.ended.turn.toPrecision(5)} T` : m.period ? `periodic, ${m.period}T` : "does not return";
    return {
      turn: Float64Array.from(samples, (k) => k / steps), time: Float64Array.from(samples, (k) => (k / steps) * m.time * m.sizes[m.sizes.length - 1]),
      time_unit: names.units.time, series: Object.fromEntries(Object.entries(all).map(([name, values]) => [name, part(values)])),
      units: names.units, values: m.values, section, spectrum: spectrum && { quantity, ...spectrum }, numbers,
      label: {
        name: m.period ? "periodic" : "undecided", text, period: m.period, decided: m.period > 0, status: m.ended ? "ended" : "ok",
        settled_after: Math.round(m.settled / record.common), steps,
      },
    };
  }

  // --- the source -----------------------------------------------------------------------------------------------------------

  // Functions that the page asks; motions that were computed are remembered.
  function source(text) {
    let opened = null, remembered = new Map();
    const open = async () => {
      const data = JSON.parse(new TextDecoder().decode(await whirlmapLive.unpack(text.data)));
      const buffer = await whirlmapLive.unpack(text.bytes);
      return { data, buffer, live: data.live ? new whirlmapLive.Live(data.live, buffer) : null };
    };
    const ready = () => (opened = opened || open());
    // Says on the page how far a long computation is: a machine of many states takes seconds.
    const progress = () => {
      const begun = performance.now();
      return (turns) => { if (typeof document !== "undefined" && performance.now() - begun > 1000) explorer.say(`computing … ${Math.round(turns)} T`); };
    };
    const motion = async (values) => {
      const { data, buffer, live } = await ready(), key = JSON.stringify(data.page.controls.filter((c) => c.axis).map((c) => values[c.name]));
      if (!remembered.has(key)) {
        if (remembered.size > 7) remembered.delete(remembered.keys().next().value);
        remembered.set(key, live ? await liveMotion(live, data, values, { tell: progress() }) : storedMotion(data, buffer, values));
      }
      return remembered.get(key);
    };
    const made = {
      load: async () => {
        const { data, live } = await ready();
        if (live && data.live.axes.length) made.coexisting = async (values, along, quantity) => {
          const found = await coexisting(live, data, values, along);
          const shown = Object.entries(found).map(([way, m]) => [way, m && described(m, data, values, quantity)]);
          return { running: false, done: 1, total: 1, result: Object.fromEntries(shown) }; // a job that is done
        };
        for (const c of data.page.controls) {
          const own = live ? data.live.axes.find((a) => a.name === c.name).values : data.stored.motions.map((m) => m.values[c.name]);
          c.points = [...new Set(own)].sort((a, b) => a - b);
        }
        if (typeof location !== "undefined" && location.protocol === "about:") { // in a notebook: no address to write or copy
          explorer.address.write = () => {};
          document.getElementById("link").hidden = true;
        }
        const say = (id, text, after) => {
          if (!text || typeof document === "undefined") return;
          const note = document.createElement("p");
          Object.assign(note, { className: "line", id, textContent: text });
          document.getElementById(after).after(note);
        };
        say("note", data.note, "status");
        say("limits", data.limits, "more");
        return data.page;
      },
      motion: async (values, quantity) => described(await motion(values), (await ready()).data, values, quantity),
      computed: motion,
    };
    return made;
  }

  return { source };
})();
if (typeof module !== "undefined") module.exports = whirlmapSaved;
