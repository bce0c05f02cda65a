/* Cells of a map: their borders along an axis, the cell in which a pixel lies, and the colours of their codes. */
"use strict";
explorer.cells = (() => {
  /** Borders of the cells of an axis: midway, of a logarithmic one in its logarithm. */
  const borders = (values, log) => {
    const t = log ? Math.log : (v) => v, back = log ? Math.exp : (v) => v, n = values.length, out = new Float64Array(n + 1);
    for (let i = 1; i < n; i++) out[i] = back((t(values[i - 1]) + t(values[i])) / 2);
    if (n === 1) { // a single value has no neighbours: a twentieth of it to either side
      const half = Math.abs(values[0]) / 20 || 1;
      return Float64Array.of(values[0] - half, values[0] + half);
    }
    out[0] = back(t(values[0]) - (t(values[1]) - t(values[0])) / 2);
    out[n] = back(t(values[n - 1]) + (t(values[n - 1]) - t(values[n - 2])) / 2);
    return out;
  };

  /** Index of the cell in which each pixel along an axis lies; -1 outside. */
  const cells = (count, value, edges) => {
    const out = new Int32Array(count).fill(-1);
    for (let p = 0; p < count; p++) {
      const v = value(p);
      let low = 0, high = edges.length - 1;
      if (v < edges[0] || v >= edges[high]) continue;
      while (high - low > 1) { const m = (low + high) >> 1; if (edges[m] <= v) low = m; else high = m; }
      out[p] = low;
    }
    return out;
  };

  const HATCHED = new Set(["contact", "diverged", "drifting", "growing", "not_settled"]);
  const NOT_COMPUTED = 255;
  /** Colours of all codes, as [r, g, b, hatched]. */
  const palette = () => {
    const out = Array(256).fill([...explorer.rgb("not_computed"), false]);
    for (const r of explorer.data.regimes) out[r.code] = [...explorer.rgb(r.name), HATCHED.has(r.name)];
    return out;
  };

  /** Indices of the points of layer `k` of a diagram, swept one way, in whose place no later layer has points of that way. A
      layer that is not complete takes the place of earlier points where it has points itself: the others stay. */
  const uncovered = (layers, k, way, state, log) => {
    const covers = layers.slice(k + 1).filter((l) => l.section[way]?.[state] && l.axes[0].values.length > 1).map((l) => {
      const values = l.section[way][state], count = l.axes[0].values.length, each = values.length / count;
      const has = (i) => !l.incomplete || values.subarray(i * each, (i + 1) * each).some(Number.isFinite);
      return {edges: borders(l.axes[0].values, log), has};
    });
    const x = layers[k].axes[0].values, out = [];
    for (let i = 0; i < x.length; i++) {
      const covered = covers.some(({edges, has}) => { const at = cells(1, () => x[i], edges)[0]; return at >= 0 && has(at); });
      if (!covered) out.push(i);
    }
    return out;
  };
  return {borders, cells, palette, uncovered, HATCHED, NOT_COMPUTED};
})();
