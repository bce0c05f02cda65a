// Power spectrum of a motion with its lines and their names, as whirlmap.analysis.spectra computes them.
"use strict";

const whirlmapSpectrum = (() => {
  // Half-width of the main lobe of Hann's window [bins]; probability that noise alone shows a line; least share of a line.
  const LOBE = 2, FALSE_ALARM = 1e-3, LEAST = 1e-8;
  // Names (line_names.py): denominator of fractions, share of the spectrum that sums of orders may cover by chance.
  const PARTS = 8, CHANCE = 0.1;
  // Bins that are kept of a spectrum, and lines that are named.
  const BINS = 2400, LINES = 12;

  // --- transform ------------------------------------------------------------------------------------------------------

  // Discrete Fourier transform in place, of a length that is a power of two.
  function transform(re, im) {
    const n = re.length;
    for (let i = 1, j = 0; i < n; i++) {
      let bit = n >> 1;
      for (; j & bit; bit >>= 1) j ^= bit;
      j ^= bit;
      if (i < j) { [re[i], re[j]] = [re[j], re[i]]; [im[i], im[j]] = [im[j], im[i]]; }
    }
    const c = new Float64Array(n / 2), s = new Float64Array(n / 2);
    for (let k = 0; k < n / 2; k++) { c[k] = Math.cos((2 * Math.PI * k) / n); s[k] = -Math.sin((2 * Math.PI * k) / n); }
    for (let half = 1; half < n; half *= 2) {
      const stride = n / (2 * half);
      for (let i = 0; i < n; i += 2 * half) {
        for (let k = 0; k < half; k++) {
          const a = i + k, b = a + half, wr = c[k * stride], wi = s[k * stride];
          const tr = re[b] * wr - im[b] * wi, ti = re[b] * wi + im[b] * wr;
          re[b] = re[a] - tr; im[b] = im[a] - ti;
          re[a] += tr; im[a] += ti;
        }
      }
    }
  }

  // |transform|^2 of real numbers of any length, bins 0 to n/2: Bluestein's chirp (1970), a convolution of a longer length.
  function squares(x) {
    const n = x.length, m = 1 << Math.ceil(Math.log2(2 * n - 1));
    const [ar, ai, br, bi] = [0, 0, 0, 0].map(() => new Float64Array(m)), cr = new Float64Array(n), ci = new Float64Array(n);
    for (let k = 0; k < n; k++) {
      const angle = (Math.PI * ((k * k) % (2 * n))) / n;
      cr[k] = Math.cos(angle); ci[k] = -Math.sin(angle);
      ar[k] = x[k] * cr[k]; ai[k] = x[k] * ci[k];
      br[k] = cr[k]; bi[k] = -ci[k];
      if (k) { br[m - k] = cr[k]; bi[m - k] = -ci[k]; }
    }
    transform(ar, ai);
    transform(br, bi);
    for (let k = 0; k < m; k++) {
      const re = ar[k] * br[k] - ai[k] * bi[k], im = ar[k] * bi[k] + ai[k] * br[k];
      ar[k] = re; ai[k] = -im; // the conjugate: a second transform then goes back
    }
    transform(ar, ai);
    return Float64Array.from({ length: Math.floor(n / 2) + 1 }, (_, k) => (ar[k] ** 2 + ai[k] ** 2) / m ** 2);
  }

  // --- lines (spectral_lines.py) ----------------------------------------------------------------------------------------

  // Running median of so many values, the ends mirrored; the upper of two.
  function runningMedian(x, width) {
    const n = x.length, at = (i) => { const k = ((i % (2 * n)) + 2 * n) % (2 * n); return x[k < n ? k : 2 * n - 1 - k]; };
    const order = [...x.keys()].sort((a, b) => x[a] - x[b]), rank = new Int32Array(n), level = new Float64Array(n);
    order.forEach((i, r) => { rank[i] = r; level[r] = x[i]; });
    const rankAt = (i) => { const k = ((i % (2 * n)) + 2 * n) % (2 * n); return rank[k < n ? k : 2 * n - 1 - k]; };
    const tree = new Int32Array(n + 1); // counts of the window by rank (Fenwick)
    const add = (r, v) => { for (let k = r + 1; k <= n; k += k & -k) tree[k] += v; };
    const top = 1 << Math.floor(Math.log2(n));
    const find = (count) => {
      let k = 0;
      for (let step = top; step; step >>= 1) if (k + step <= n && tree[k + step] <= count) { k += step; count -= tree[k]; }
      return level[k];
    };
    const before = Math.floor(width / 2), out = new Float64Array(n);
    for (let i = -before; i < width - before; i++) add(rankAt(i), 1);
    for (let i = 0; i < n; i++) {
      out[i] = find(Math.floor(width / 2));
      add(rankAt(i - before), -1);
      add(rankAt(i - before + width), 1);
    }
    return out;
  }

  // Broadband level about each bin.
  function floorOf(density, width) {
    const n = density.length, half = 4 * LOBE, reach = half + LOBE + 1;
    const near = runningMedian(density, 2 * half + 1), wide = runningMedian(density, width);
    const clipped = (i) => near[Math.min(Math.max(i, 0), n - 1)];
    return wide.map((v, i) => Math.max(v, clipped(i - reach), clipped(i + reach)) / Math.LN2);
  }

  // Largest power of a line so many bins away as a share of its highest bin: Hann's response, at the worst place within a bin.
  const leakage = (() => {
    const fine = 16, bins = 256, sinc = (v) => (v === 0 ? 1 : Math.sin(Math.PI * v) / (Math.PI * v));
    const response = Float64Array.from({ length: bins * fine }, (_, k) => {
      const f = k / fine;
      return (0.5 * sinc(f) + 0.25 * (sinc(f - 1) + sinc(f + 1))) ** 2 * 4;
    });
    for (let k = response.length - 2; k >= 0; k--) response[k] = Math.max(response[k], response[k + 1]);
    const highest = (0.5 * sinc(0.5) + 0.25 * (sinc(-0.5) + sinc(1.5))) ** 2 * 4;
    return Float64Array.from({ length: bins }, (_, k) => response[Math.max(k * fine - fine / 2, 0)] / highest);
  })();

  // Lines, the strongest first: frequency in bins, and power in sums of the density.
  function linesOf(density) {
    const n = density.length, width = Math.max(Math.floor(n / 32), 30 * LOBE + 1);
    if (width > n / 2) return [];
    const floor = floorOf(density, width), threshold = Math.log(n / FALSE_ALARM);
    let total = 0;
    for (const v of density) total += v;
    const bins = [];
    for (let k = 4 * LOBE; k < n; k++) {
      const peak = density[k] > density[k - 1] && (k === n - 1 || density[k] > density[k + 1]);
      if (peak && density[k] >= threshold * floor[k] && density[k] >= LEAST * total) bins.push(k);
    }
    const strong = bins.filter((k) => {
      let leaked = 0;
      for (const other of bins) {
        const apart = Math.abs(other - k);
        if (apart && apart < leakage.length) leaked = Math.max(leaked, leakage[apart] * density[other]);
      }
      return density[k] > 4 * leaked;
    });
    const found = strong.map((k, j) => {
      const from = Math.max(k - LOBE, j ? Math.floor((strong[j - 1] + k) / 2) + 1 : 0);
      const to = Math.min(k + LOBE, j + 1 < strong.length ? Math.floor((k + strong[j + 1]) / 2) : n - 1, n - 1);
      let power = 0;
      for (let i = from; i <= to; i++) power += density[i] - floor[i];
      const [a, b, c] = [k - 1, k, k + 1 < n ? k + 1 : k - 1].map((i) => Math.log(Math.max(density[i], 2.3e-308)));
      const curvature = a - 2 * b + c;
      return { bin: k + (curvature < 0 ? (a - c) / 2 / curvature : 0), power };
    });
    return found.sort((one, other) => other.power - one.power);
  }

  // --- names (line_names.py) ----------------------------------------------------------------------------------------------

  function* bounded(count, most) {
    if (!count) { yield []; return; }
    for (let first = -most; first <= most; first++) for (const rest of bounded(count - 1, most - Math.abs(first))) yield [first, ...rest];
  }
  const sum = (values) => values.reduce((a, b) => a + b, 0);
  const frequencyOf = (c, sizes) => sum(c.map((k, i) => k * sizes[i]));

  function mostOf(sizes, tolerance, highest) {
    for (let most = sizes.length > 2 ? 6 : 10; most > 2; most--) {
      const distinct = new Set();
      for (const c of bounded(sizes.length, most)) {
        const at = frequencyOf(c, sizes);
        if (at > 0 && at <= highest) distinct.add(Math.round(at / tolerance));
      }
      if (distinct.size * 2 * tolerance < CHANCE * highest) return most;
    }
    return 2;
  }

  const compare = (a, b) => { for (let i = 0; i < a.length; i++) if (a[i] !== b[i]) return a[i] - b[i]; return 0; };
  function written(c, names) {
    let text = "";
    for (const [k, name] of c.map((k, i) => [k, names[i]]).sort((a, b) => (a[0] < 0) - (b[0] < 0))) {
      if (k) text += (text ? (k < 0 ? " - " : " + ") : k < 0 ? "-" : "") + (Math.abs(k) !== 1 ? `${Math.abs(k)} ` : "") + name;
    }
    return text;
  }

  const divisor = (a, b) => (b ? divisor(b, a % b) : a);
  function nameOf(f, names, sizes, tolerance, combinations) {
    for (const c of combinations) if (Math.abs(frequencyOf(c, sizes) - f) <= tolerance) return written(c, names);
    for (let q = 2; q <= PARTS; q++) {
      for (let i = 0; i < names.length; i++) {
        const p = Math.round((f / sizes[i]) * q);
        if (p > 0 && Math.abs(f - (p * sizes[i]) / q) <= tolerance) {
          const d = divisor(p, q);
          return `${q === d ? p / d : `${p / d}/${q / d}`} ${names[i]}`;
        }
      }
    }
    return "";
  }

  // Names of frequencies after the turns per T of clocks; at most two frequencies that these do not name become bases.
  function named(frequencies, clocks, step) {
    const tolerance = step / 5, highest = Math.max(step, ...frequencies);
    const bases = Object.entries(clocks).filter(([, v]) => tolerance < Math.abs(v) / (2 * PARTS)).map(([k, v]) => [k, Math.abs(v)]);
    let out = frequencies.map(() => "");
    for (const extra of ["f1", "f2", ""]) {
      if (bases.length) {
        const names = bases.map((b) => b[0]), sizes = bases.map((b) => b[1]), most = mostOf(sizes, tolerance, highest);
        const keyed = [...bounded(names.length, most)].filter((c) => c.some((k) => k)).map((c) => [
          [sum(c.map(Math.abs)), c.filter((k) => k).length, ...c.map((k) => -Math.abs(k)), ...c.map((k) => -k)], c]);
        const combinations = keyed.sort((a, b) => compare(a[0], b[0])).map((one) => one[1]);
        out = frequencies.map((f) => nameOf(f, names, sizes, tolerance, combinations));
      }
      const unnamed = frequencies.filter((_, k) => !out[k]);
      if (!extra || !unnamed.length || unnamed[0] <= 2 * PARTS * tolerance) break;
      bases.push([extra, unnamed[0]]);
    }
    return out;
  }

  // --- all of it ------------------------------------------------------------------------------------------------------------

  // Spectrum of a series of so many samples per T, as a page shows it; null where nothing moves.
  function spectrum(values, rate, clocks) {
    const n = values.length;
    let mean = 0, low = Infinity, high = -Infinity;
    for (const v of values) { mean += v / n; low = Math.min(low, v); high = Math.max(high, v); }
    if (n < 64 || !(high - low > 1e-12 * Math.max(Math.abs(low), Math.abs(high)))) return null;
    let weights = 0;
    const x = Float64Array.from(values, (v, k) => {
      const w = 0.5 - 0.5 * Math.cos((2 * Math.PI * k) / n);
      weights += w;
      return (v - mean) * w;
    });
    const found = squares(x), step = rate / n;
    const power = found.map((v, k) => ((k > 0 && 2 * k < n ? 2 : 1) * v) / weights ** 2);
    const lines = linesOf(power), whole = sum([...power]);
    const top = lines.slice(0, LINES), frequencies = top.map((l) => l.bin * step), names = named(frequencies, clocks, step);
    const last = Math.max(4, ...Object.values(clocks).map((v) => 4 * Math.abs(v)));
    const seen = Math.min(power.length, Math.floor(last / step * (1 + 1e-12)) + 1), group = Math.ceil(seen / BINS), best = [];
    for (let k = 0; k + group <= seen; k += group) {
      let at = k;
      for (let i = k + 1; i < k + group; i++) if (power[i] > power[at]) at = i;
      best.push(at);
    }
    return {
      frequency: Float64Array.from(best, (k) => k * step), power: Float64Array.from(best, (k) => power[k]),
      lines: top.map((l, k) => ({ frequency: frequencies[k], share: l.power / whole, name: names[k] || null })),
      broadband: 1 - sum(lines.map((l) => l.power)) / whole,
    };
  }

  return { spectrum, runningMedian };
})();
if (typeof module !== "undefined") module.exports = whirlmapSpectrum;
