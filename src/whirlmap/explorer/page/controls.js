/* Sliders and numbers of the quantities that can be changed. */
"use strict";
explorer.controls = (() => {
  const {$, make} = explorer;
  const STEPS = 1000, FIRST = 4, rows = new Map();

  const indexOf = (points, v) => points.reduce((best, p, k) => (Math.abs(p - v) < Math.abs(points[best] - v) ? k : best), 0);
  /** Steps of a slider: one for each point where there are motions of these alone. */
  const stepsOf = (c) => (c.points ? c.points.length - 1 : STEPS);
  const toSlider = (c, v) => {
    if (c.points) return indexOf(c.points, v);
    const u = c.log && v > 0 ? Math.log(v / c.low) / Math.log(c.high / c.low) : (v - c.low) / (c.high - c.low);
    return Math.round(STEPS * Math.min(Math.max(u, 0), 1));
  };
  const fromSlider = (c, k) => (c.points ? c.points[k] : +between(c, k).toPrecision(6));
  const between = (c, k) => (c.log ? c.low * (c.high / c.low) ** (k / STEPS) : c.low + (c.high - c.low) * k / STEPS);
  const written = (c, v) => String(+(v * c.size).toPrecision(8));

  const choice = (c) => {
    const element = make("div", "", {class: "control"}), label = make("label", "", {for: `v-${c.name}`, title: c.meaning});
    label.append(make("b", c.symbol), ` ${c.meaning}`);
    const select = make("select", "", {id: `v-${c.name}`});
    select.append(...c.choices.map((word) => make("option", word, {value: word})));
    select.addEventListener("change", () => explorer.change({[c.name]: select.value}));
    element.append(label, select);
    rows.set(c.name, {c, select});
    return element;
  };

  const row = (c) => {
    if (c.choices) return choice(c);
    const element = make("div", "", {class: "control"}), label = make("label", "", {for: `v-${c.name}`, title: c.meaning});
    const unit = explorer.unit(c.unit);
    label.append(make("b", c.symbol), ` ${c.meaning}`);
    const number = make("input", "", {type: "number", step: "any", id: `v-${c.name}`});
    const slider = make("input", "", {type: "range", min: 0, max: stepsOf(c), "aria-label": `${c.symbol}, ${c.meaning}`});
    slider.addEventListener("input", () => explorer.change({[c.name]: fromSlider(c, +slider.value)}));
    number.addEventListener("change", () => {
      const v = number.valueAsNumber;
      if (Number.isFinite(v)) explorer.change({[c.name]: v / c.size});
      number.value = written(c, explorer.value(c.name)); // what is shown, where that is another value
    });
    element.append(label, number, make("span", unit, {class: "unit"}), slider);
    rows.set(c.name, {c, number, slider});
    return element;
  };

  const update = () => {
    for (const {c, number, slider, select} of rows.values()) {
      const v = explorer.value(c.name);
      if (select) { select.value = v; continue; }
      if (document.activeElement !== number) number.value = written(c, v);
      if (document.activeElement !== slider) slider.value = toSlider(c, v);
    }
    $("reset").hidden = !others().length;
    $("again").hidden = !others().length || explorer.data.kind === "point" || !explorer.source.finer;
  };

  /** Quantities beside the axes that have other values than the case's: the map is not of these. */
  const others = () => Object.keys(explorer.state.values).filter((k) => !explorer.control(k).axis);

  const begin = () => {
    const all = explorer.data.controls, axes = all.filter((c) => c.axis).length;
    $("controls").replaceChildren(...all.slice(0, axes + FIRST).map(row));
    $("more-controls").replaceChildren(...all.slice(axes + FIRST).map(row));
    $("more").hidden = all.length <= axes + FIRST;
    $("reset").addEventListener("click", () => {
      const kept = Object.entries(explorer.state.values).filter(([k]) => explorer.control(k).axis);
      explorer.set({values: Object.fromEntries(kept)});
    });
    explorer.listeners.push((changed) => { if (changed.has("values")) update(); });
    update();
  };
  return {begin, update, others};
})();
