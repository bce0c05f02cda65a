/* Branches of periodic orbits over a diagram, dashed where they are unstable; curves of bifurcations over a map, each kind with
   its own dashes. A dot at each event, with its words below the map or diagram. */
"use strict";
explorer.branchLines = (() => {
  const {make, array, digits} = explorer;
  const DASHES = {fold: [], "period-doubling": [7, 4], "neimark-sacker": [2, 3]}, MOST = 12;
  const words = (kind) => kind.replaceAll("-", " ").replace("neimark sacker", "Neimark-Sacker").replace("resonance 1 ", "resonance 1:");
  const all = () => [...explorer.data.branches || [], ...explorer.branches];
  const names = () => explorer.layers[0].axes.map((a) => a.name);

  /** Pieces of a line in which its branch, and what `same` compares, stay: [from, to). Neighbours share a point. */
  const pieces = function* (of, same) {
    for (let from = 0; from < of.length;) {
      let to = from + 1;
      while (to < of.length && of[to] === of[from] && same(to, to - 1)) to++;
      yield [from, to < of.length && of[to] === of[from] ? to + 1 : to];
      from = to;
    }
  };

  /** Lines over a map lie on any colour: a light line below a dark one. */
  const stroke = (ctx, path, dash, dpr, outlined) => {
    ctx.setLineDash(dash.map((d) => d * dpr));
    if (outlined) { ctx.strokeStyle = explorer.colour("card"); ctx.lineWidth = 3.6 * dpr; ctx.setLineDash([]); path(); ctx.setLineDash(dash.map((d) => d * dpr)); }
    ctx.strokeStyle = explorer.colour("ink"); ctx.lineWidth = (outlined ? 1.6 : 1.2) * dpr;
    path();
    ctx.setLineDash([]);
  };

  const draw = (ctx, X, Y, dpr) => {
    const axes = names(), map = axes.length > 1;
    for (const b of all()) {
      const x = array(b.values[axes[0]]), of = array(b.branch), stable = array(b.stable);
      const section = map ? null : array(b.section[explorer.state.section]);
      if (!map && !section) continue;
      const rows = map ? 1 : section.length / x.length;
      for (const [from, to] of pieces(of, (i, j) => map || stable[i] === stable[j])) {
        const dash = map ? DASHES[b.kind] || [] : stable[from] ? [] : [4, 3];
        for (let k = 0; k < rows; k++) {
          const y = map ? array(b.values[axes[1]]).subarray(from, to) : Float64Array.from({length: to - from}, (_, i) => section[(from + i) * rows + k]);
          stroke(ctx, () => explorer.path(ctx, X, Y, x.subarray(from, to), y), dash, dpr, map);
        }
      }
      const at = b.events.map((e) => [e.values[axes[0]], map ? e.values[axes[1]] : e.section[explorer.state.section]]).filter((p) => p.every(Number.isFinite));
      ctx.fillStyle = explorer.colour("ink");
      explorer.dots(ctx, X, Y, at.map((p) => p[0]), at.map((p) => p[1]), 3.2 * dpr);
    }
  };

  /** What the lines are, and where their events lie, as items of a list. */
  const legend = () => {
    const lines = all(), axes = names(), out = [];
    for (const kind of new Set(lines.map((b) => b.kind))) {
      const item = make("li", kind ? `curve of ${words(kind)} points` : "branch, dashed where unstable");
      item.prepend(make("span", "", {class: `stroke ${kind || "branch"}`}));
      out.push(item);
    }
    const events = lines.flatMap((b) => b.events);
    for (const e of events.slice(0, MOST)) {
      const at = axes.map((n) => { const c = explorer.control(n); return `${c.symbol} = ${explorer.withUnit(e.values[n] * c.size, c.unit, 5)}`; });
      out.push(make("li", `• ${words(e.kind)} at ${at.join(", ")}`));
    }
    if (events.length > MOST) out.push(make("li", `and ${digits(events.length - MOST)} more`));
    return out;
  };
  return {draw, legend};
})();
