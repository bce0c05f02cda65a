/* Branches of periodic orbits over a diagram: dashed where they are unstable, a dot at each bifurcation. */
"use strict";
explorer.drawBranches = (ctx, X, Y, dpr) => {
  for (const b of [...explorer.data.branches || [], ...explorer.branches]) {
    const values = explorer.array(b.values), of = explorer.array(b.branch), stable = explorer.array(b.stable);
    const section = explorer.array(b.section[explorer.state.section]);
    if (!section || b.name !== explorer.layers[0].axes[0].name) continue;
    const rows = section.length / values.length;
    ctx.strokeStyle = explorer.colour("ink");
    ctx.lineWidth = 1.2 * dpr;
    for (let from = 0; from < values.length;) {
      let to = from + 1;
      while (to < values.length && of[to] === of[from] && stable[to] === stable[to - 1]) to++;
      const last = to < values.length && of[to] === of[from] ? to + 1 : to;
      ctx.setLineDash(stable[from] ? [] : [4 * dpr, 3 * dpr]);
      for (let k = 0; k < rows; k++) {
        const y = Float64Array.from({length: last - from}, (_, i) => section[(from + i) * rows + k]);
        explorer.path(ctx, X, Y, values.subarray(from, last), y);
      }
      from = to;
    }
    ctx.setLineDash([]);
    ctx.fillStyle = explorer.colour("ink");
    const at = b.events.filter((e) => Number.isFinite(e.section[explorer.state.section]));
    explorer.dots(ctx, X, Y, at.map((e) => e.value), at.map((e) => e.section[explorer.state.section]), 3.2 * dpr);
  }
};
