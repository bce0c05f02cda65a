// Live motions of a saved page: the model's own kernels, compiled to WebAssembly, run at one operating point.
//
// What Python does in whirlmap.integrate (ensemble.py, group.py, step_retry.py) for many points is done here for one: the
// point stands in all lanes of one block, of which the first is active. Arrays are rows of LANES numbers.
"use strict";

const whirlmapLive = (() => {
  const LANES = 8;
  // Bytes at the beginning of a module's memory that are its stack; bytes between two arrays, and of a page of memory.
  const STACK = 1 << 20, ALIGNED = 64, PAGE = 1 << 16;
  const { harmonicTables, phases, angles } = whirlmapHarmonics;
  // Shorter steps that a failed one is tried in; bisections of the end of a run, and steps of each trial (step_retry.py).
  const TRIED = [4, 16, 64, 256, 1024], BISECTIONS = 50, TRIAL_STEPS = 4;
  // Milliseconds of one call of a kernel, after which the page answers.
  const CALL = 40;
  let answered = 0;
  const answer = async () => {
    if (performance.now() - answered < CALL) return;
    await new Promise((resolve) => setTimeout(resolve));
    answered = performance.now();
  };

  // --- data ---------------------------------------------------------------------------------------------------------

  // Undo base64 and gzip; resolves to an ArrayBuffer.
  async function unpack(text) {
    const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new Response(stream).arrayBuffer();
  }

  // Values of packed rows at one point of the grid, given its index along each axis.
  function gathered(rows, numbers, index) {
    return rows.map(([at, ...strides]) => numbers[strides.reduce((sum, stride, k) => sum + stride * index[k], at)]);
  }

  // --- a module -----------------------------------------------------------------------------------------------------

  async function loaded(bytes) {
    const memory = new WebAssembly.Memory({ initial: 2 * STACK / PAGE });
    const env = { __linear_memory: memory };
    env.__stack_pointer = new WebAssembly.Global({ value: "i32", mutable: true }, STACK);
    for (const name of Object.getOwnPropertyNames(Math)) if (typeof Math[name] === "function") env[name] = Math[name];
    const { instance } = await WebAssembly.instantiate(bytes, { env });
    return { memory, functions: instance.exports };
  }

  // Lay arrays out in a module's memory. Returns what to pass, and views of the arrays, by the names of the arguments.
  function placed(module, names, values) {
    const at = {};
    let end = STACK;
    for (const name of names) {
      if (typeof values[name] === "bigint") continue;
      at[name] = end;
      end = Math.ceil((end + values[name].byteLength + ALIGNED) / ALIGNED) * ALIGNED;
    }
    const missing = end - module.memory.buffer.byteLength;
    if (missing > 0) module.memory.grow(Math.ceil(missing / PAGE));
    const views = {};
    for (const name in at) {
      const given = values[name];
      views[name] = new given.constructor(module.memory.buffer, at[name], given.length);
      views[name].set(given);
    }
    return { views, passed: names.map((name) => (name in at ? at[name] : values[name])) };
  }

  const repeated = (numbers) => Float64Array.from({ length: LANES * numbers.length }, (_, i) => numbers[Math.floor(i / LANES)]);
  const whole = (numbers) => BigInt64Array.from({ length: LANES * numbers.length }, (_, i) => BigInt(numbers[Math.floor(i / LANES)]));

  // --- one operating point --------------------------------------------------------------------------------------------

  class Point {
    constructor(model, index) {
      const { description: d, numbers } = model;
      const take = (rows) => gathered(rows, numbers, index);
      this.model = model;
      this.variant = model.variants[take(d.variant)[0]];
      this.steps = take(d.steps)[0];
      this.pieces = take(d.pieces)[0];
      this.period = take(d.period)[0];
      const orders = take(d.orders), count = orders.length / 2;
      this.orders = orders.slice(0, count).map((p, i) => [p, orders[count + i]]);
      this.p = repeated(take(this.variant.inputs));
      this.offsets = whole(take(this.variant.offsets));
      this.start = take(d.start);
      this.harmonics = null; // tables, made when they are needed
      this.length = 256; // steps of one call
      this.restart();
    }

    // Go back to the start state.
    restart() {
      const d = this.model.description;
      this.x = [...this.start, ...Array(this.variant.sizes.surfaces).fill(d.unknown_side)];
      this.done = 0;
      this.ended = null;
    }

    // Begin at another state, at phase zero.
    begin(state) {
      this.restart();
      state.forEach((value, i) => { this.x[i] = value; });
    }

    // Take a whole number of steps; with `every`, resolves to the states after every so many of them, sample by sample.
    async advance(steps, every = 0) {
      const { sizes, module } = await this.variant.ready(), d = this.model.description;
      const states = sizes.states, saves = every ? Math.floor(steps / every) : 0, blank = new Float64Array(LANES);
      const tables = (this.harmonics = this.harmonics || harmonicTables(this.orders, this.steps, this.variant.nodes));
      const rows = Object.fromEntries(["starts", "lengths", "strides", "far"].map((name) => [name, whole(tables[name])]));
      const saved = new Float64Array(Math.max(saves * states, 1) * LANES).fill(NaN);
      const never = BigInt(steps) + 1n;
      const { views, passed } = placed(module.locked, d.arguments.advance, {
        blocks: 1n, count: 0n, y: repeated(this.x), h: repeated([this.period / this.steps]), p: this.p,
        tables: this.variant.tables, offsets: this.offsets, waves: tables.waves, ...rows, turns: repeated(tables.turns),
        begin: whole(this.orders.map(() => 0n)), first: whole([0n]), last: whole([0n]), active: whole([0n]),
        failed: whole([-1n]), save_every: whole([every ? BigInt(every) : never]), saves: BigInt(saves), saved,
        orth_every: whole([never]), events: 0n, growth: blank, folded: 0n, sums: blank, cause: whole([0n]),
        reached: repeated([0]), tally: repeated([0, 0]), pieces: whole([this.pieces]),
        work: new Float64Array(sizes.work * LANES),
      });
      views.active[0] = 1n;
      const keep = (step) => {
        if (every && step % every === 0)
          for (let i = 0; i < states; i++) views.saved[((step / every - 1) * states + i) * LANES] = views.y[i * LANES];
      };
      let taken = 0;
      while (taken < steps && !this.ended) {
        const from = taken, last = Math.min(taken + this.length, steps), begun = performance.now();
        views.begin.set(whole(phases(this.orders, this.steps, this.done + taken)));
        views.first[0] = BigInt(taken);
        views.last[0] = BigInt(last);
        module.locked.functions.advance(...passed);
        const failed = Number(views.failed[0]);
        if (failed >= 0) {
          views.failed[0] = -1n;
          this.x = Array.from({ length: this.x.length }, (_, i) => views.y[i * LANES]);
          await this.retry(this.done + failed, views.reached[0]);
          this.x.forEach((value, i) => { views.y[i * LANES] = value; });
          if (!this.ended) keep(failed + 1);
          taken = this.ended ? failed : failed + 1;
        } else taken = last;
        const each = Math.max(performance.now() - begun, 0.01) / (last - from);
        this.length = Math.max(Math.floor(Math.min(CALL / each, 8 * this.length)), 16);
        await answer();
      }
      this.x = Array.from({ length: this.x.length }, (_, i) => views.y[i * LANES]);
      this.done += taken;
      return Float64Array.from({ length: saves * states }, (_, i) => views.saved[i * LANES]);
    }

    // Redo a failed step in shorter ones; where none gets through, locate where the run ends (StepRetry in step_retry.py).
    async retry(done, part) {
      const h = ((1 - part) * this.period) / this.steps, origin = angles(this.orders, this.steps, done, part);
      if (!this.variant.singular && this.beyond((await this.march(origin, h, 1))[0])) {
        this.ended = { turn: (done + 1) / this.steps };
        return;
      }
      for (const count of TRIED) {
        const [x, good] = await this.march(origin, h / count, count);
        if (good) { this.x = x; return; }
      }
      let low = 0, high = 1, last = this.x;
      for (let k = 0; k < BISECTIONS; k++) {
        const middle = (low + high) / 2, [x, good] = await this.march(origin, (h * middle) / TRIAL_STEPS, TRIAL_STEPS);
        if (good) [low, last] = [middle, x];
        else high = middle;
      }
      this.x = last;
      this.ended = { turn: (done + part + low * (1 - part)) / this.steps };
    }

    // Whether a state is finite, and beyond the sizes at which it has diverged.
    beyond(x) {
      const { states, inputs } = this.variant.sizes;
      let size = 0;
      for (let i = 0; i < states; i++) size += Math.abs(x[i]) * this.p[(inputs - 2 * states + i) * LANES];
      return Number.isFinite(size) && size >= 1;
    }

    async march(origin, h, steps) {
      const { sizes, module } = await this.variant.ready();
      const { views, passed } = placed(module.free, this.model.description.arguments.march, {
        blocks: 1n, count: 0n, y: repeated(this.x), time: repeated([0]), origin: repeated(origin.length ? origin : [0]),
        h: repeated([h]), p: this.p, tables: this.variant.tables, offsets: this.offsets, steps: BigInt(steps),
        good: whole([0n]), work: new Float64Array(sizes.free_work * LANES),
      });
      module.free.functions.march(...passed);
      return [this.x.map((_, i) => views.y[i * LANES]), views.good[0] !== 0n];
    }

    // Outputs at states, sample by sample.
    async outputs(x) {
      const { sizes, module } = await this.variant.ready();
      const samples = x.length / sizes.states, blocks = Math.ceil(samples / LANES);
      if (!sizes.outputs || !samples) return new Float64Array(0);
      const many = (rows) => new Float64Array(Math.max(blocks * rows, 1) * LANES);
      const y = many(sizes.states), p = many(sizes.inputs), offsets = new BigInt64Array(blocks * this.offsets.length);
      for (let b = 0; b < blocks; b++) {
        p.set(this.p, b * this.p.length);
        offsets.set(this.offsets, b * this.offsets.length);
        for (let l = 0; l < LANES; l++) {
          const sample = Math.min(b * LANES + l, samples - 1);
          for (let i = 0; i < sizes.states; i++) y[(b * sizes.states + i) * LANES + l] = x[sample * sizes.states + i];
        }
      }
      const { views, passed } = placed(module.free, this.model.description.arguments.evaluate, {
        blocks: BigInt(blocks), forced: 1n, y, time: many(1), p, tables: this.variant.tables, offsets,
        dy: many(sizes.states), jac: many(0), o: many(sizes.outputs), work: new Float64Array(sizes.free_work * LANES),
      });
      module.free.functions.evaluate(...passed);
      return Float64Array.from({ length: samples * sizes.outputs }, (_, k) => {
        const sample = Math.floor(k / sizes.outputs), block = Math.floor(sample / LANES);
        return views.o[(block * sizes.outputs + (k % sizes.outputs)) * LANES + (sample % LANES)];
      });
    }
  }

  // --- the model --------------------------------------------------------------------------------------------------------

  class Live {
    // description, buffer: what whirlmap.explorer.saved.live_motions packed
    constructor(description, buffer) {
      this.description = description;
      this.numbers = new Float64Array(buffer, description.numbers[0], description.numbers[1]);
      this.variants = description.variants.map((v) => {
        const bytes = ([at, size]) => buffer.slice(at, at + size);
        let waiting = null;
        const load = async () => ({ ...v, module: { locked: await loaded(bytes(v.locked)), free: await loaded(bytes(v.free)) } });
        return {
          ...v, tables: new Float64Array(buffer, v.tables[0], v.tables[1]),
          ready: () => (waiting = waiting || load()),
        };
      });
    }

    // Index of the live point nearest to values of the axes, along each axis.
    nearest(values) {
      return this.description.axes.map(({ name, values: own }) => {
        let best = 0;
        own.forEach((value, k) => { if (Math.abs(value - values[name]) < Math.abs(own[best] - values[name])) best = k; });
        return best;
      });
    }

    point(index) { return new Point(this, index); }

    // Values of packed rows at a point.
    take(rows, index) { return gathered(rows, this.numbers, index); }

    // Values of the axes at a point.
    values(index) {
      return Object.fromEntries(this.description.axes.map(({ name, values: own }, k) => [name, own[index[k]]]));
    }

    // The motion at the live point nearest to values of the axes: states and outputs over `periods` T, after `transient` T.
    async motion(values, { transient = 100, periods = 20, every = 1 } = {}) {
      const index = this.nearest(values), point = this.point(index), d = this.description;
      await point.advance(transient * point.steps);
      const begun = point.done, first = Float64Array.from(point.x.slice(0, d.states.length));
      const later = point.ended ? new Float64Array(0) : await point.advance(periods * point.steps, every);
      const rows = point.ended ? Math.floor((point.done - begun) / every) : Math.floor((periods * point.steps) / every);
      const x = new Float64Array((rows + 1) * d.states.length);
      x.set(first);
      x.set(later.subarray(0, rows * d.states.length), d.states.length);
      const turn = Float64Array.from({ length: rows + 1 }, (_, k) => (begun + k * every) / point.steps);
      return {
        values: this.values(index), period: point.period, steps: point.steps, turn, x, outputs: await point.outputs(x), ended: point.ended,
      };
    }
  }

  return { unpack, Live };
})();
if (typeof module !== "undefined") module.exports = whirlmapLive;
