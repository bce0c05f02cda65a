/* Panels: axes, ticks and zoom are those of uPlot; what lies between the axes is drawn by each panel. */
"use strict";

/** A colour of the style sheet. */
explorer.colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();

/** The same as [red, green, blue]. */
explorer.rgb = (name) => {
  const text = explorer.colour(name).replace("#", "");
  return [0, 2, 4].map((k) => parseInt(text.slice(k, k + 2), 16));
};

/** Colour ramp for numbers, safe for every colour vision (cividis), from 0 to 1. */
explorer.ramp = (u) => {
  const stops = [[0, 32, 77], [49, 68, 107], [102, 105, 112], [149, 143, 120], [203, 186, 105], [255, 233, 69]];
  const x = Math.min(Math.max(u, 0), 1) * (stops.length - 1), k = Math.min(Math.floor(x), stops.length - 2), f = x - k;
  return stops[k].map((c, i) => Math.round(c + f * (stops[k + 1][i] - c)));
};

/** Ends of an axis about some numbers: a span that is rounding alone is widened, so that a rest does not look like a motion. */
explorer.span = (low, high, size) => {
  if (!(low <= high)) return [-1, 1];
  const least = 1e-6 * Math.max(Math.abs(low), Math.abs(high), size || 0) || 1e-12;
  const half = Math.max((high - low) / 2, least) * 1.06, middle = (low + high) / 2;
  return [middle - half, middle + half];
};
explorer.ends = (...arrays) => {
  let low = Infinity, high = -Infinity;
  for (const a of arrays) for (let i = 0; i < a.length; i++) { const v = a[i]; if (v < low) low = v; if (v > high) high = v; }
  return [low, high];
};

/** Ticks of a logarithmic axis. uPlot's own do not end where 1e-6 * 10 is not 1e-5 to the last bit. */
explorer.logTicks = (low, high) => {
  const decades = Math.log10(high / low), steps = decades > 3 ? [1] : decades > 1.2 ? [1, 2, 5] : [1, 1.5, 2, 3, 4, 5, 6, 8], out = [];
  for (let e = Math.floor(Math.log10(low)); e <= Math.log10(high); e++) {
    for (const s of steps) { const v = Number(`${s}e${e}`); if (v >= low && v <= high) out.push(v); }
  }
  return out;
};

/** Round ticks of an axis whose numbers are written in another unit: `size` of it are one of its own. */
explorer.ticks = (low, high, size, count) => {
  const rough = (high - low) * size / count, power = 10 ** Math.floor(Math.log10(rough)), out = [];
  const step = power * [1, 2, 5, 10].find((s) => s * power >= rough);
  for (let k = Math.ceil(low * size / step); k * step <= high * size; k++) out.push(k * step / size);
  return out;
};

/** Texts of ticks, in as many digits as tell them apart: those of a flat axis differ late. */
explorer.tickTexts = (splits, size = 1) => {
  const own = splits.filter((v) => v !== null), step = Math.min(...own.slice(1).map((v, k) => Math.abs(v - own[k])));
  const needed = Math.ceil(Math.log10(Math.max(...own.map(Math.abs)) / step)) + 2;
  const n = own.length > 1 && Number.isFinite(needed) ? Math.min(Math.max(6, needed), 15) : 6;
  return splits.map((v) => (v === null ? "" : explorer.digits(v * size, n)));
};

/** A panel in an element: `show({x, y, equal, data, series, draw, onClick, onZoom})` draws it anew. */
explorer.Panel = class {
  constructor(element) {
    this.element = element;
    this.options = null;
    this.plot = null;
    this.dragged = false;
    new ResizeObserver(() => this.redraw()).observe(element);
  }

  /** Say why there is nothing to draw. */
  empty(text) {
    this.clear();
    this.options = null;
    this.element.append(explorer.make("div", text, {class: "empty"}));
  }

  clear() {
    this.plot?.destroy();
    this.plot = null;
    this.element.replaceChildren();
  }

  show(options) {
    this.options = options;
    const width = this.element.clientWidth, height = this.element.clientHeight;
    if (width < 40 || height < 40) return;
    this.clear();
    const {x, y, series = [], data = null} = options;
    const axis = (a, side) => ({
      side, label: a.label, labelSize: 18, labelGap: 0, size: side === 3 ? 52 : 30, gap: 3, font: "11px system-ui, sans-serif",
      labelFont: "12px system-ui, sans-serif", stroke: explorer.colour("muted"),
      grid: {stroke: explorer.colour("grid"), width: 1}, ticks: {stroke: explorer.colour("line"), width: 1, size: 4},
      values: (u, splits) => explorer.tickTexts(splits, a.size || 1),
      ...(a.log ? {splits: (u, k, low, high) => explorer.logTicks(low, high), filter: (u, splits) => splits}
        : {splits: (u, k, low, high) => explorer.ticks(low, high, a.size || 1, Math.max((k ? height / 45 : width / 75), 2))}),
    });
    const ranges = {x: [...x.range], y: [...y.range]};
    if (options.equal) this.equalise(ranges, width - 78, height - 62);
    const scale = (a, range) => ({time: false, auto: false, range: () => range, ...(a.log ? {distr: 3, log: 10} : {})});
    this.plot = new uPlot({
      width, height, padding: [8, 10, 0, 0], legend: {show: false}, series: [{}, ...(series.length ? series : [{show: false}])],
      scales: {x: scale(x, ranges.x), y: scale(y, ranges.y)}, axes: [axis(x, 2), axis(y, 3)],
      cursor: {
        show: Boolean(options.onZoom), points: {show: false}, y: Boolean(options.onZoom),
        drag: {x: true, y: !options.zoomX, uni: 10, setScale: false},
      },
      hooks: {
        draw: [(u) => this.inside(u, options.draw)],
        setSelect: [(u) => this.selected(u)],
        setCursor: [(u) => options.onHover?.(u.cursor.left < 0 ? null : this.at(u.cursor.left, u.cursor.top))],
      },
    }, data || [[ranges.x[0], ranges.x[1]], [null, null]], this.element);
    if (options.onClick) {
      this.plot.over.addEventListener("click", (event) => {
        if (!this.dragged) options.onClick(this.at(event.offsetX, event.offsetY));
        this.dragged = false;
      });
    }
  }

  /** Values at a place in the plot. */
  at(left, top) { return {x: this.plot.posToVal(left, "x"), y: this.plot.posToVal(top, "y")}; }

  redraw() { if (this.options) this.show(this.options); }
  /** Draw what lies between the axes anew, and nothing else. */
  refresh() { this.plot?.redraw(false, false); }

  selected(u) {
    const s = {...u.select};
    if (!this.options.onZoom || (s.width < 4 && s.height < 4)) return;
    this.dragged = true;
    setTimeout(() => { this.dragged = false; }, 60);
    const a = this.at(s.left, s.top + s.height), b = this.at(s.left + s.width, s.top);
    const full = {x: this.options.x.range, y: this.options.y.range};
    u.setSelect({left: 0, top: 0, width: 0, height: 0}, false);
    const whole = (k, size, most) => size < 4 || size >= most - 1;
    this.options.onZoom({
      x: whole("x", s.width, u.over.clientWidth) ? full.x : [a.x, b.x],
      y: whole("y", s.height, u.over.clientHeight) ? full.y : [a.y, b.y],
    });
  }

  /** The same length of both axes, for an orbit. */
  equalise(ranges, width, height) {
    const per = Math.max((ranges.x[1] - ranges.x[0]) / width, (ranges.y[1] - ranges.y[0]) / height);
    for (const [k, n] of [["x", width], ["y", height]]) {
      const middle = (ranges[k][0] + ranges[k][1]) / 2;
      ranges[k] = [middle - per * n / 2, middle + per * n / 2];
    }
  }

  inside(u, draw) {
    if (!draw) return;
    const {ctx, bbox} = u;
    ctx.save();
    ctx.beginPath();
    ctx.rect(bbox.left, bbox.top, bbox.width, bbox.height);
    ctx.clip();
    draw(ctx, u, {X: (v) => u.valToPos(v, "x", true), Y: (v) => u.valToPos(v, "y", true), dpr: uPlot.pxRatio || devicePixelRatio});
    ctx.restore();
  }
};

/** Draw a line through points; a gap where a number is missing. */
explorer.path = (ctx, X, Y, x, y, from = 0, to = x.length) => {
  ctx.beginPath();
  let pen = false;
  for (let i = from; i < to; i++) {
    if (!Number.isFinite(x[i]) || !Number.isFinite(y[i])) { pen = false; continue; }
    if (pen) ctx.lineTo(X(x[i]), Y(y[i])); else ctx.moveTo(X(x[i]), Y(y[i]));
    pen = true;
  }
  ctx.stroke();
};
explorer.dots = (ctx, X, Y, x, y, radius) => {
  ctx.beginPath();
  for (let i = 0; i < x.length; i++) {
    const px = X(x[i]), py = Y(y[i]);
    ctx.moveTo(px + radius, py);
    ctx.arc(px, py, radius, 0, 2 * Math.PI);
  }
  ctx.fill();
};
