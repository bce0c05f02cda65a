/* The panels of a motion: orbit, section, time series, spectrum, films and loads; its label, numbers and votes. */
"use strict";
explorer.panels = (() => {
  const {$, make, digits, array} = explorer;
  const panel = {};

  /** A motion with its arrays decoded. */
  const decoded = (m) => ({
    ...m, turn: array(m.turn), time: array(m.time), series: explorer.arrays(m.series), section: explorer.arrays(m.section),
    spectrum: m.spectrum && {...m.spectrum, frequency: array(m.spectrum.frequency), power: array(m.spectrum.power)},
  });

  /** Values of a series at given turns, on straight lines between its samples. */
  const between = (turn, values, at) => at.map((t) => {
    const step = (turn[turn.length - 1] - turn[0]) / (turn.length - 1), k = Math.min(Math.floor((t - turn[0]) / step + 1e-9), turn.length - 2);
    const f = (t - turn[k]) / (turn[k + 1] - turn[k]);
    return values[k] + f * (values[k + 1] - values[k]);
  });

  /** Clock whose turns are marked: the fastest that is slower than once per T, else T itself. */
  const marked = () => {
    const slower = Object.entries(explorer.data.clocks).filter(([, r]) => r < 1 - 1e-9).sort((a, b) => b[1] - a[1]);
    return slower[0] || ["T", 1];
  };

  const motions = () => [["", explorer.shown], ...Object.entries(explorer.others).filter(([, m]) => m)];
  const inkOf = (way) => explorer.colour(way || explorer.shown.label.name === "undecided" ? (way || "ink") : "periodic");

  const orbit = () => {
    const m = explorer.shown, plane = explorer.data.planes[explorer.state.plane] || explorer.data.planes[0];
    if (!plane) { panel.orbit.empty("this model has one state"); return; }
    const all = motions().map(([way, one]) => [way, one, one.series[plane.x], one.series[plane.y]]);
    const unit = (name) => m.units[name];
    const [shaft, rate] = marked();
    const xs = explorer.span(...explorer.ends(...all.map((a) => a[2]))), ys = explorer.span(...explorer.ends(...all.map((a) => a[3])));
    const q = (name) => explorer.quantityOf(name).symbol;
    panel.orbit.show({
      x: {range: xs, label: explorer.axisLabel(q(plane.x), unit(plane.x))}, y: {range: ys, label: explorer.axisLabel(q(plane.y), unit(plane.y))},
      equal: plane.equal,
      draw: (ctx, u, {X, Y, dpr}) => {
        if (plane.clearance && m.units[plane.x] === "1") {
          ctx.strokeStyle = explorer.colour("muted"); ctx.lineWidth = dpr;
          ctx.beginPath(); ctx.ellipse(X(0), Y(0), Math.abs(X(1) - X(0)), Math.abs(Y(1) - Y(0)), 0, 0, 2 * Math.PI); ctx.stroke();
        }
        for (const [way, one, x, y] of all) {
          ctx.globalAlpha = x.length > 1500 && !one.label.period ? 0.55 : 1;
          ctx.strokeStyle = inkOf(way); ctx.lineWidth = (x.length > 1500 ? 0.7 : 1.1) * dpr;
          explorer.path(ctx, X, Y, x, y);
          ctx.globalAlpha = 1;
          const last = one.turn[one.turn.length - 1], at = Array.from({length: Math.floor(last * rate + 1e-9) + 1}, (_, k) => Math.min(k / rate, last));
          ctx.fillStyle = explorer.colour(way || "chaotic");
          explorer.dots(ctx, X, Y, between(one.turn, x, at), between(one.turn, y, at), 2.6 * dpr);
        }
      },
    });
    panel.orbit.element.setAttribute("aria-label", `Orbit of ${plane.name}, marked once per ${shaft === "T" ? "T" : `turn of the ${shaft}`}`);
  };

  const noSection = (label) => (label.status !== "ok" ? "the run ended" : label.name === "at_rest" ? "this is at rest" : "no point of this motion lies in it");
  const section = () => {
    const name = explorer.state.quantity in explorer.shown.section ? explorer.state.quantity : explorer.data.swing[0];
    const other = explorer.data.velocities[name] || explorer.data.states.find((s) => s.name !== name)?.name || name;
    const all = motions().map(([way, one]) => [way, one.section[name], one.section[other], one]);
    const points = all[0][1];
    if (!points?.length) { panel.section.empty(`no section: ${noSection(explorer.shown.label)}`); $("section-line").textContent = ""; return; }
    const size = (n) => Math.max(...explorer.ends(explorer.shown.series[n]).map(Math.abs));
    const spread = (n, k) => {
      const whole = explorer.ends(explorer.shown.series[n]), own = explorer.ends(...all.map((a) => a[k]));
      const least = 0.02 * (whole[1] - whole[0]), middle = (own[0] + own[1]) / 2, half = Math.max((own[1] - own[0]) / 2, least);
      return explorer.span(middle - half, middle + half, size(n));
    };
    panel.section.show({
      x: {range: spread(name, 1), label: explorer.axisLabel(explorer.quantityOf(name).symbol, explorer.shown.units[name])},
      y: {range: spread(other, 2), label: explorer.axisLabel(explorer.quantityOf(other).symbol, explorer.shown.units[other])},
      draw: (ctx, u, {X, Y, dpr}) => {
        for (const [way, x, y, one] of all) {
          if (!x?.length) continue;
          ctx.fillStyle = explorer.colour(way || "ink");
          explorer.dots(ctx, X, Y, x, y, (one.label.period ? 3 : 1.5) * dpr);
        }
      },
    });
    const clusters = explorer.clusters(points, explorer.shown.section[other], spread(name, 1), spread(other, 2));
    const per = explorer.data.forced ? "once per T" : "crossings";
    const n = explorer.shown.label.period, near = n && n !== clusters; // places so near that the panel does not tell them apart
    const places = near ? `, ${n} of them different` : clusters <= 64 ? ` in ${clusters} place${clusters > 1 ? "s" : ""}` : "";
    $("section-line").textContent = `${per}, ${points.length} points${places}`;
    explorer.shown.clusters = clusters;
  };

  /** Number of different places among points, at a hundredth of the range. */
  explorer.clusters = (x, y, xs, ys) => {
    const found = [];
    for (let i = 0; i < x.length && found.length <= 200; i++) {
      const a = (x[i] - xs[0]) / (xs[1] - xs[0]), b = (y[i] - ys[0]) / (ys[1] - ys[0]);
      if (!found.some(([c, d]) => Math.abs(a - c) < 0.005 && Math.abs(b - d) < 0.005)) found.push([a, b]);
    }
    return found.length;
  };

  const lineOptions = (colour, width = 1.1) => ({stroke: explorer.colour(colour), width, points: {show: false}, spanGaps: false});
  const curves = (target, names, label, range) => {
    const m = explorer.shown, columns = names.map((n) => m.series[n]);
    target.show({
      x: {range: [m.turn[0], m.turn[m.turn.length - 1] || 1], label: "time [T]"},
      y: {range: range || explorer.span(...explorer.ends(...columns)), label},
      data: [m.turn, ...columns], series: names.map((_, k) => lineOptions(COLOURS[k % 4])),
    });
  };

  const series = () => {
    const name = explorer.state.quantity;
    curves(panel.series, [name], explorer.axisLabel(explorer.quantityOf(name).symbol, explorer.shown.units[name]));
  };

  const spectrum = () => {
    const s = explorer.shown.spectrum, list = $("lines");
    list.replaceChildren();
    if (!s) { panel.spectrum.empty("no spectrum: the run ended, or this does not move"); $("spectrum-line").textContent = ""; return; }
    const top = explorer.ends(s.power)[1], level = Float64Array.from(s.power, (p) => 10 * Math.log10(Math.max(p / top, 1e-16)));
    const named = s.lines.filter((l) => l.name);
    panel.spectrum.show({
      x: {range: [0, s.frequency[s.frequency.length - 1]], label: "frequency [1/T]"}, y: {range: [-125, 14], label: "power [dB]"},
      data: [s.frequency, level], series: [lineOptions("periodic", 1)],
      draw: (ctx, u, {X, Y, dpr}) => {
        ctx.font = `${10.5 * dpr}px system-ui, sans-serif`; ctx.fillStyle = explorer.colour("ink"); ctx.textAlign = "center";
        const taken = [];
        for (const l of named) {
          const x = X(l.frequency), wide = ctx.measureText(l.name).width;
          const side = Math.max(u.bbox.left + wide / 2, Math.min(x, u.bbox.left + u.bbox.width - wide / 2));
          if (x < u.bbox.left || x > u.bbox.left + u.bbox.width || taken.some(([a, w]) => Math.abs(a - side) < (w + wide) / 2 + 6 * dpr)) continue;
          taken.push([side, wide]);
          ctx.fillText(l.name, side, Y(3) - 2 * dpr);
        }
      },
    });
    for (const l of s.lines.slice(0, 8)) list.append(make("li", `${l.name || "unnamed"} at ${digits(l.frequency)}: ${digits(100 * l.share, 3)} %`));
    $("spectrum-line").textContent = `of ${explorer.quantityOf(s.quantity).symbol}; ${digits(100 * s.broadband, 2)} % of the power outside of lines`;
  };

  const COLOURS = ["periodic", "chaotic", "quasi_periodic", "growing"];
  const films = () => {
    const known = explorer.data.films.filter((f) => f.eccentricity);
    $("films-card").hidden = !known.length;
    if (!known.length) return;
    $("bearings").replaceChildren(...known.map((f, k) => {
      const item = make("li", `bearing ${f.bearing}`), swatch = make("span", "", {class: "swatch"});
      swatch.style.backgroundColor = explorer.colour(COLOURS[k % 4]);
      item.prepend(swatch);
      return item;
    }));
    const ends = explorer.ends(...known.map((f) => explorer.shown.series[f.eccentricity]));
    curves(panel.films, known.map((f) => f.eccentricity), "eccentricity", [0, Math.max(1, ends[1] * 1.04)]);
    const loaded = known.filter((f) => f.load);
    if (!loaded.length) { panel.loads.empty("the model says no loads"); return; }
    curves(panel.loads, loaded.map((f) => f.load), explorer.axisLabel("film force", explorer.shown.units[loaded[0].load]));
  };

  const label = () => {
    const m = explorer.shown, swatch = make("span", "", {class: "swatch"});
    let text = m.label.text, name = m.label.name;
    if (!m.label.decided && explorer.verdict) { text = explorer.verdict.regime; name = text.replaceAll("-", "_"); }
    else if (!m.label.decided && explorer.stored) { text = `${explorer.stored.text}`; name = explorer.stored.name; }
    swatch.style.backgroundColor = explorer.colour(name) || "transparent";
    $("label").replaceChildren(swatch, text);
    const rows = [];
    for (const n of m.numbers) rows.push([n.name, explorer.withUnit(n.value, n.unit)]);
    rows.push(["settled after", `${m.label.settled_after ?? "–"} common periods`], ["steps per T", String(m.label.steps ?? "–")]);
    $("numbers").replaceChildren(...rows.map(([k, v]) => { const r = make("tr"); r.append(make("th", k), make("td", v)); return r; }));
    votes();
  };

  const says = (name, v) => {
    const n = v.value ?? v.digits ?? v.distance ?? v.broadband_fraction ?? v.largest ?? null;
    const error = v.error ? ` ± ${digits(v.error, 2)}` : "";
    return `${v.vote ?? "–"}${typeof n === "number" ? ` (${digits(n, 3)}${error})` : ""}`;
  };
  const votes = () => {
    const v = explorer.verdict, rows = [];
    if (v) {
      rows.push(["label", v.regime + (v.period ? `, ${v.period}T` : "")], ["confidence", digits(v.confidence, 3)]);
      for (const [name, one] of Object.entries(v.indicators)) {
        if (name === "rule") continue;
        rows.push([name.replaceAll("_", " "), says(name, one)]);
      }
      if (v.lyapunov?.length) rows.push(["largest exponent, 1/time", `${digits(v.lyapunov[0], 3)} ± ${digits(v.lyapunov_error[0], 2)}`]);
      if (v.kaplan_yorke !== null && v.kaplan_yorke !== undefined) rows.push(["Kaplan-Yorke dimension", digits(v.kaplan_yorke, 3)]);
    } else if (explorer.stored) rows.push([explorer.stored.where, explorer.stored.text]);
    $("votes").replaceChildren(...rows.map(([k, t]) => { const r = make("tr"); r.append(make("th", k), make("td", t)); return r; }));
  };

  const show = () => { if (explorer.shown) { label(); orbit(); section(); series(); spectrum(); films(); } };
  const begin = () => {
    for (const name of ["orbit", "section", "series", "spectrum", "films", "loads"]) panel[name] = new explorer.Panel($(name));
    const planes = explorer.data.planes.map((p, k) => make("option", p.name, {value: k}));
    $("plane").replaceChildren(...planes);
    const all = [...explorer.data.states, ...explorer.data.outputs];
    $("quantity").replaceChildren(...all.map((q) => make("option", `${q.symbol}, ${q.meaning}`, {value: q.name})));
  };
  return {begin, show, label, decoded, orbit, section};
})();
