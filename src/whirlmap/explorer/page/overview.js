/* The map or the diagram: regimes of all points, the chosen one, branches, and finer parts over coarser ones. */
"use strict";
explorer.overview = (() => {
  const {$, make, digits} = explorer, {borders, cells, palette, uncovered, HATCHED, NOT_COMPUTED} = explorer.cells;
  let panel, raster = null, key = "";

  /** Decode points over their axes; later layers lie over earlier ones. */
  const layer = (o) => ({
    axes: o.axes.map((a) => ({name: a.name, values: explorer.array(a.values)})),
    regime: explorer.array(o.regime), period: explorer.array(o.period), units: o.units || {}, incomplete: o.incomplete || "",
    numbers: Object.fromEntries(Object.entries(o.numbers || {}).map(([k, n]) => [k, {...n, values: explorer.array(n.values)}])),
    section: Object.fromEntries(Object.entries(o.section || {}).map(([way, states]) => [way, explorer.arrays(states)])),
  });

  const axisOf = (k) => explorer.control(explorer.layers[0].axes[k].name);
  const map = () => explorer.data.kind === "map";

  /** The whole of an axis, half a cell beyond its ends. */
  const whole = (k) => {
    const c = axisOf(k), values = explorer.layers[0].axes[k].values, edges = borders(values, c.log), n = values.length;
    return [values[0] === c.low ? edges[0] : c.low, values[n - 1] === c.high ? edges[n] : c.high];
  };

  /** Ranges that are shown, in the model's own numbers. */
  const ranges = () => {
    const zoom = explorer.state.zoom, x = zoom?.x || whole(0);
    if (map()) return {x, y: zoom?.y || whole(1)};
    if (zoom?.y) return {x, y: zoom.y};
    const all = Object.values(explorer.layers[0].section).map((s) => s[explorer.state.section]).filter(Boolean);
    return {x, y: explorer.span(...explorer.ends(...all))};
  };

  /** Colour of a point of a layer, as a function of its index. */
  const painter = (l) => {
    const colours = palette(), absent = [...explorer.rgb("absent"), false], number = l.numbers[explorer.state.colour];
    const none = (i) => (l.regime[i] === NOT_COMPUTED ? colours[NOT_COMPUTED] : absent);
    if (number) {
      const [low, high] = scaleOf(explorer.state.colour);
      return (i) => {
        const v = number.values[i];
        return Number.isFinite(v) ? [...explorer.ramp((v - low) / (high - low || 1)), false] : none(i);
      };
    }
    if (explorer.state.colour === "period") {
      return (i) => (l.regime[i] === 1 ? [...explorer.ramp(Math.log2(Math.max(l.period[i], 1)) / 7), false] : none(i));
    }
    return (i) => colours[l.regime[i]];
  };
  /** Ends of the colour scale of a number: the middle 98 of 100 points. */
  const scaleOf = (name) => {
    const all = Array.from(explorer.layers[0].numbers[name].values).filter(Number.isFinite).sort((a, b) => a - b);
    const at = (q) => all[Math.min(Math.floor(q * all.length), all.length - 1)];
    return all.length ? [at(0.01), at(0.99)] : [0, 1];
  };

  /** Whether a point of a finer part is still to be computed: the coarser one shows there. */
  const toCome = (l, i) => l !== explorer.layers[0] && l.incomplete && l.regime[i] === NOT_COMPUTED;

  const paint = (u) => {
    const {bbox} = u, width = Math.round(bbox.width), height = Math.round(bbox.height);
    const canvas = document.createElement("canvas");
    canvas.width = width; canvas.height = height;
    const ctx = canvas.getContext("2d"), image = ctx.createImageData(width, height), pixels = image.data;
    const ratio = width / u.over.clientWidth, hatch = explorer.rgb("hatch");
    const X = (p) => u.posToVal((p + 0.5) / ratio, "x"), Y = (p) => u.posToVal((p + 0.5) / ratio, "y");
    const put = (px, py, c) => {
      const k = 4 * (py * width + px), ink = c[3] && (px + py) % Math.round(7 * ratio) < ratio ? hatch : c;
      pixels[k] = ink[0]; pixels[k + 1] = ink[1]; pixels[k + 2] = ink[2]; pixels[k + 3] = 255;
    };
    for (const l of explorer.layers) {
      if (!l.regime) continue;
      const of = painter(l);
      if (map()) {
        const columns = cells(width, X, borders(l.axes[0].values, axisOf(0).log));
        const rows = cells(height, Y, borders(l.axes[1].values, axisOf(1).log)), n = l.axes[1].values.length;
        for (let py = 0; py < height; py++) {
          if (rows[py] < 0) continue;
          for (let px = 0, i; px < width; px++) if (columns[px] >= 0 && !toCome(l, i = columns[px] * n + rows[py])) put(px, py, of(i));
        }
        continue;
      }
      for (const [way, states] of Object.entries(l.section)) dots(l, states[explorer.state.section], way, of, u, ratio, put, width, height);
    }
    ctx.putImageData(image, 0, 0);
    return canvas;
  };

  /** Points of a diagram: a dot as wide as its column, but small. */
  const dots = (l, values, way, of, u, ratio, put, width, height) => {
    if (!values) return;
    const x = l.axes[0].values, each = values.length / x.length, size = (v) => Math.round(u.valToPos(v, "x") * ratio);
    const gap = x.length > 1 ? Math.abs(size(x[x.length - 1]) - size(x[0])) / (x.length - 1) : 2;
    const sparse = gap > 8 * ratio, most = Math.round((sparse ? 4 : 3) * ratio); // few points are drawn larger
    const w = Math.max(Math.round(1.4 * ratio), Math.min(Math.round(gap * 0.8), most)), h = Math.max(1, Math.round((sparse ? 3 : 1.8) * ratio));
    const fixed = way && explorer.state.colour === "regime" ? [...explorer.rgb(way), false] : null;
    for (const i of uncovered(explorer.layers, explorer.layers.indexOf(l), way, explorer.state.section, axisOf(0).log)) {
      const px = size(x[i]) - (w >> 1), c = fixed || of(i).slice(0, 3);
      for (let k = 0; k < each; k++) {
        const v = values[i * each + k];
        if (!Number.isFinite(v)) continue;
        const py = Math.round(u.valToPos(v, "y") * ratio);
        for (let a = 0; a < w; a++) for (let b = 0; b < h; b++) {
          const qx = px + a, qy = py + b;
          if (qx >= 0 && qx < width && qy >= 0 && qy < height) put(qx, qy, c);
        }
      }
    }
  };

  const draw = (ctx, u, {X, Y, dpr}) => {
    const {bbox} = u, now = [key, bbox.width, bbox.height].join();
    if (!raster || raster.key !== now) raster = {key: now, image: paint(u)};
    ctx.drawImage(raster.image, Math.round(bbox.left), Math.round(bbox.top));
    explorer.branchLines.draw(ctx, X, Y, dpr);
    const x = X(explorer.value(explorer.layers[0].axes[0].name));
    const cross = (colour, width) => {
      ctx.strokeStyle = colour; ctx.lineWidth = width * dpr;
      ctx.beginPath(); ctx.moveTo(x, bbox.top); ctx.lineTo(x, bbox.top + bbox.height);
      if (map()) {
        const y = Y(explorer.value(explorer.layers[0].axes[1].name));
        ctx.moveTo(bbox.left, y); ctx.lineTo(bbox.left + bbox.width, y);
        ctx.moveTo(x + 6 * dpr, y); ctx.arc(x, y, 6 * dpr, 0, 2 * Math.PI);
      }
      ctx.stroke();
    };
    ctx.globalAlpha = 0.7; cross(explorer.colour("card"), 3); ctx.globalAlpha = 1; cross(explorer.colour("ink"), 1);
  };

  /** Layer and index of the cell that holds values; the finest one. */
  const cellAt = (values) => {
    for (const l of [...explorer.layers].reverse()) {
      if (!l.regime || (l.incomplete && l.axes[0].values.length < 2)) continue; // of one point nobody knows how wide its cell is
      const at = l.axes.map((a, k) => cells(1, () => values[k], borders(a.values, axisOf(k).log))[0]);
      const index = map() ? at[0] * l.axes[1].values.length + at[1] : at[0];
      if (at.every((i) => i >= 0) && !toCome(l, index)) return {layer: l, at, index};
    }
    return null;
  };
  const place = (p) => (map() ? [p.x, p.y] : [p.x]);

  const words = (found) => {
    const code = found.layer.regime[found.index], regime = explorer.regime(code), n = found.layer.period[found.index];
    return regime ? regime.label + (regime.name === "periodic" && n ? `, ${n}T` : "") : "not computed";
  };
  const written = (values) => values.map((v, k) => {
    const c = axisOf(k);
    return `${c.symbol} = ${explorer.withUnit(v * c.size, c.unit)}`;
  }).join(", ");

  const hover = (p) => {
    const found = p && cellAt(place(p));
    if (!found) { $("hover").textContent = ""; return; }
    const number = found.layer.numbers[explorer.state.colour];
    const more = number ? `; ${number.label} ${explorer.withUnit(number.values[found.index], number.unit)}` : "";
    $("hover").textContent = `${written(found.at.map((i, k) => found.layer.axes[k].values[i]))}: ${words(found)}${more}`;
  };

  /** Choose the cell at a place: its own values, so that the label is that of the motion. */
  const choose = (p) => {
    const found = cellAt(place(p));
    const at = found ? found.at.map((i, k) => found.layer.axes[k].values[i]) : place(p);
    explorer.change(Object.fromEntries(at.map((v, k) => [explorer.layers[0].axes[k].name, v])));
    $("overview").focus({preventScroll: true});
  };

  const step = (axis, by) => {
    const names = explorer.layers[0].axes.map((a) => a.name), here = names.map((n) => explorer.value(n));
    const found = cellAt(here);
    const values = axisOf(axis).points || (found ? found.layer : explorer.layers[0]).axes[axis].values;
    let near = 0;
    for (let i = 0; i < values.length; i++) if (Math.abs(values[i] - here[axis]) < Math.abs(values[near] - here[axis])) near = i;
    const next = Math.min(Math.max(near + by, 0), values.length - 1);
    explorer.change({...Object.fromEntries(names.map((n, k) => [n, here[k]])), [names[axis]]: values[next]});
  };

  const zoomBy = (factor) => {
    const r = ranges(), here = explorer.layers[0].axes.map((a) => explorer.value(a.name));
    const about = (range, k, log) => {
      const t = log ? Math.log : (v) => v, back = log ? Math.exp : (v) => v, c = t(here[k]);
      const a = back(c + (t(range[0]) - c) * factor), b = back(c + (t(range[1]) - c) * factor);
      const [low, high] = whole(k);
      return [Math.max(a, low), Math.min(b, high)];
    };
    const x = about(r.x, 0, axisOf(0).log), y = map() ? about(r.y, 1, axisOf(1).log) : null;
    const all = (range, k) => range[0] <= whole(k)[0] && range[1] >= whole(k)[1];
    explorer.set({zoom: all(x, 0) && (!y || all(y, 1)) ? null : {x, ...(y ? {y} : {})}});
  };

  const keys = (event) => {
    const by = event.shiftKey ? 10 : 1;
    const moves = {ArrowLeft: [0, -by], ArrowRight: [0, by], ArrowDown: [1, -by], ArrowUp: [1, by]};
    const move = moves[event.key];
    if (move && (map() || move[0] === 0)) step(...move);
    else if (event.key === "+" || event.key === "=") zoomBy(0.5);
    else if (event.key === "-") zoomBy(2);
    else if (event.key === "Escape") explorer.set({zoom: null});
    else return;
    event.preventDefault();
  };

  const legend = () => {
    colours();
    const parts = explorer.layers.filter((l) => l.incomplete).map((l) => (l === explorer.layers[0] ? "" : "finer: ") + l.incomplete);
    const more = explorer.layers[0].incomplete && explorer.data.grows ? "; reload the page to read the store again" : "";
    Object.assign($("incomplete"), {textContent: parts.join("; ") + more, hidden: !parts.length});
    $("lines-legend").replaceChildren(...explorer.branchLines.legend());
  };
  const colours = () => {
    const list = $("legend"), number = explorer.layers[0].numbers[explorer.state.colour];
    list.replaceChildren();
    const counts = new Map();
    for (const code of explorer.layers[0].regime || []) counts.set(code, (counts.get(code) || 0) + 1);
    const total = explorer.layers[0].regime?.length || 1;
    const entry = (name, label, share) => {
      const item = make("li", share === undefined ? label : `${label} ${digits(100 * share / total, 3)} %`);
      const swatch = make("span", "", {class: `swatch${HATCHED.has(name) ? " hatched" : ""}`});
      swatch.style.backgroundColor = explorer.colour(name);
      item.prepend(swatch); list.append(item);
    };
    const missing = () => { if (counts.has(NOT_COMPUTED)) entry("not_computed", "not computed", counts.get(NOT_COMPUTED)); };
    if (number || explorer.state.colour === "period") {
      const [low, high] = number ? scaleOf(explorer.state.colour) : [1, 128];
      const item = make("li"), bar = make("span", "", {class: "ramp"});
      bar.style.background = `linear-gradient(90deg, ${[0, 0.2, 0.4, 0.6, 0.8, 1].map((u) => `rgb(${explorer.ramp(u)})`).join()})`;
      const unit = number ? explorer.unit(number.unit) : "";
      item.append(make("span", number ? number.label : "period in T"), make("br"), digits(low, 3), bar, digits(high, 3) + unit);
      list.append(item);
      missing();
      return;
    }
    const swept = Object.keys(explorer.layers[0].section).filter(Boolean);
    for (const way of swept) entry(way, `swept ${way}`);
    if (swept.length) return;
    for (const r of explorer.data.regimes) if (counts.has(r.code)) entry(r.name, r.label, counts.get(r.code));
    missing();
  };

  const show = () => {
    const l = explorer.layers[0];
    if (!l) return;
    key = JSON.stringify([explorer.state.zoom, explorer.state.colour, explorer.state.section, document.documentElement.dataset.theme,
      explorer.layers.map((one) => one.version)]);
    const r = ranges(), x = axisOf(0), y = map() ? axisOf(1) : null;
    const log = (c, range) => c.log && range[1] / range[0] > 8;
    const q = map() ? null : explorer.quantityOf(explorer.state.section);
    panel.show({
      x: {range: r.x, log: log(x, r.x), label: explorer.axisLabel(x.symbol, x.unit), size: x.size},
      y: y ? {range: r.y, log: log(y, r.y), label: explorer.axisLabel(y.symbol, y.unit), size: y.size}
        : {range: r.y, label: explorer.axisLabel(q?.symbol || "", l.units[explorer.state.section])},
      draw, onClick: choose, onHover: hover, onZoom: (zoom) => explorer.set({zoom}),
    });
    $("back").hidden = !explorer.state.zoom;
    legend();
  };

  const begin = () => {
    if (explorer.data.kind === "point") { $("overview-card").hidden = true; return; }
    panel = new explorer.Panel($("overview"));
    replace(explorer.data.overview);
    $("overview-title").textContent = map() ? "Regime map" : "Bifurcation diagram";
    $("state-pick").hidden = map();
    $("overview").addEventListener("keydown", keys);
    $("back").addEventListener("click", () => explorer.set({zoom: null}));
    fillChoices();
    explorer.listeners.push((changed) => {
      if (["zoom", "colour", "section"].some((k) => changed.has(k))) show();
      else if (changed.has("values")) panel.refresh();
    });
  };

  const fillChoices = () => {
    const l = explorer.layers[0], states = Object.keys(Object.values(l.section)[0] || {});
    const choices = [["regime", "regime"], ["period", "period"], ...Object.entries(l.numbers).map(([k, n]) => [k, n.label])];
    $("colour").replaceChildren(...choices.map(([value, text]) => make("option", text, {value})));
    $("state").replaceChildren(...states.map((s) => make("option", explorer.quantityOf(s).symbol, {value: s})));
    if (l.regime && !choices.some(([k]) => k === explorer.state.colour)) explorer.set({colour: "regime"});
    if (states.length && !states.includes(explorer.state.section)) explorer.set({section: states[0]});
    $("colour").value = explorer.state.colour; $("state").value = explorer.state.section;
  };

  let versions = 0;
  /** Show other points in place of all that there are. */
  const replace = (o) => {
    explorer.layers = [{...layer(o), version: ++versions}];
    if (panel?.options) { fillChoices(); show(); }
  };
  /** Lay points over those that there are; `slot` is an earlier layer that they replace. */
  const add = (o, slot) => {
    const made = {...layer(o), version: ++versions, slot};
    explorer.layers = [...explorer.layers.filter((l) => l.slot !== slot || slot === undefined), made];
    show();
  };
  /** Values of the axes at the cell that holds the case's own. */
  const first = () => {
    const names = explorer.layers[0].axes.map((a) => a.name), found = cellAt(names.map((n) => explorer.value(n)));
    return found ? Object.fromEntries(found.at.map((i, k) => [names[k], found.layer.axes[k].values[i]])) : {};
  };
  return {begin, first, show, replace, add, ranges, cellAt, words, written, legend, refresh: () => { panel?.refresh(); legend(); }};
})();
