// Cosines and sines of the forcing for steps that are locked to its phase, as whirlmap.kernels.running.lanes tabulates them
// (HarmonicTables): every harmonic repeats after the denominator of its order times the steps per T, and phases are counted
// in whole numbers.
"use strict";

const whirlmapHarmonics = (() => {
  // Rows of the longest table of a harmonic; where it would be longer, its phase is counted, and turned on from step to step.
  const LONGEST = 1 << 17;

  const modulo = (a, n) => ((a % n) + n) % n;

  // Tables of harmonics of the orders [numerator, denominator], for so many steps per T.
  function harmonicTables(orders, steps, nodes) {
    const waves = [], rows = { starts: [], lengths: [], strides: [], far: [], turns: [] };
    for (const [p, q] of orders) {
      const length = q * steps, far = length > LONGEST;
      rows.starts.push(waves.length);
      rows.lengths.push(length);
      rows.far.push(far ? 1 : 0);
      rows.strides.push(far ? modulo(p, length) : 1);
      rows.turns.push((2 * Math.PI * p) / length);
      const first = waves.length;
      const times = far ? [...nodes, 1.0].map((node) => [0, node]) : [];
      if (!far) for (let k = 0; k < length; k++) for (const node of nodes) times.push([modulo(k * p, length), node]);
      for (const [k, node] of times) {
        const turn = far ? (p * node) / length : (k + p * node) / length;
        waves.push(Math.cos(2 * Math.PI * turn), Math.sin(2 * Math.PI * turn));
      }
      waves.push(waves[first], waves[first + 1]);
    }
    return { waves: Float64Array.from(waves.length ? waves : [0]), ...rows };
  }

  // Step of each harmonic's cycle, or its phase, after so many steps from phase zero; exact whole numbers.
  function phases(orders, steps, done) {
    return orders.map(([p, q]) => {
      const length = BigInt(q) * BigInt(steps), at = BigInt(done) % length;
      return q * steps > LONGEST ? modulo(at * BigInt(p), length) : at;
    });
  }

  // Angle of each harmonic within its turn, a part of a step behind that.
  function angles(orders, steps, done, part) {
    return orders.map(([p, q]) => {
      const length = BigInt(q) * BigInt(steps);
      const turn = Number(modulo((BigInt(done) % length) * BigInt(p), length)) / Number(length);
      return 2 * Math.PI * (turn + (p / (q * steps)) * part);
    });
  }

  return { harmonicTables, phases, angles };
})();
if (typeof module !== "undefined") module.exports = whirlmapHarmonics;
