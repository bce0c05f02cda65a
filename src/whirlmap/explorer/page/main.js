/* The page comes to life: state to motion, jobs, theme. */
"use strict";
(() => {
  const {$} = explorer;
  explorer.say = (text, wrong = false) => { $("status").textContent = text; $("status").classList.toggle("error", wrong); };

  // Motion of the chosen point: one request at a time, the newest wins.
  let busy = false, again = false, control = null, timer = 0, told = "";
  /** Mark what is shown as the motion of values that were asked before: the newest could not be computed. */
  const old = (yes) => { for (const part of [".panels", ".facts", "#label"]) document.querySelector(part).classList.toggle("old", yes); };
  const ask = async () => {
    if (busy) { again = true; return; }
    busy = true;
    const asked = performance.now(), values = {...explorer.state.values}, quantity = explorer.state.quantity;
    document.querySelector(".panels").classList.add("waiting");
    const slow = setTimeout(async () => {
      explorer.say("computing …");
      try { if ((await explorer.source.state?.())?.compiling) explorer.say("compiling kernels, once for this machine …"); } catch { /* said below */ }
    }, 700);
    try {
      const m = explorer.panels.decoded(await explorer.source.motion(values, quantity, control?.signal));
      if (told !== JSON.stringify(values)) { explorer.verdict = null; explorer.others = {}; $("coexisting").textContent = ""; told = JSON.stringify(values); }
      explorer.shown = m;
      explorer.stored = stored();
      explorer.say(explorer.moved);
      explorer.panels.show();
      explorer.timing = {asked, drawn: performance.now()};
      if (!explorer.verdict && (explorer.state.autoVotes || !(m.label.decided || explorer.stored))) { clearTimeout(timer); timer = setTimeout(votes, 600); }
      old(false);
    } catch (error) {
      explorer.say(error.message, true);
      explorer.failed = error.message;
      old(true);
    } finally {
      clearTimeout(slow);
      busy = false;
      document.querySelector(".panels").classList.remove("waiting");
      if (again) { again = false; ask(); }
    }
  };

  /** What the map says of the chosen point, where the map is of its values. */
  const stored = () => {
    if (explorer.data.kind === "point" || explorer.controls.others().length) return null;
    const found = explorer.overview.cellAt(explorer.layers[0].axes.map((a) => explorer.value(a.name)));
    if (!found || !found.layer.axes.every((a, k) => a.values[found.at[k]] === explorer.value(a.name))) return null;
    const regime = explorer.regime(found.layer.regime[found.index]);
    return regime && {text: explorer.overview.words(found), name: regime.name, where: `label in the ${explorer.data.kind}`};
  };

  const where = () => {
    const names = [...new Set([...explorer.data.controls.filter((c) => c.axis).map((c) => c.name), ...Object.keys(explorer.state.values)])];
    $("where").textContent = names.map((n) => {
      const c = explorer.control(n);
      return `${c.symbol} = ${c.choices ? explorer.value(n) : explorer.withUnit(explorer.value(n) * c.size, c.unit, 6)}`;
    }).join(", ");
  };

  // Jobs of the server, and their progress.
  const wait = (ms) => new Promise((done) => setTimeout(done, ms));
  const shown = new Set();
  const bar = () => {
    const jobs = [...shown], p = $("progress");
    p.hidden = !jobs.length; $("cancel").hidden = !jobs.length;
    if (!jobs.length) return;
    const known = jobs.every((j) => j.total), done = jobs.reduce((s, j) => s + j.done, 0), total = jobs.reduce((s, j) => s + j.total, 0);
    p.classList.toggle("open", !known);
    p.firstElementChild.style.width = known ? `${100 * done / total}%` : "";
  };
  /** Follow a job to its end; `take(result)` at every new result. */
  const follow = async (report, take, visible = true) => {
    let job = {...report};
    if (visible) shown.add(job);
    try {
      for (;;) {
        if (job.result !== undefined) take(job.result, job);
        bar();
        if (!job.running) break;
        await wait(250);
        const next = await explorer.source.job(job.job, job.version);
        delete job.result;
        Object.assign(job, next);
      }
    } finally { shown.delete(job); bar(); }
    if (job.error && job.error !== "cancelled") throw new Error(job.error);
    return job;
  };
  const attempt = async (work) => { try { await work(); } catch (error) { explorer.say(error.message, true); explorer.failed = error.message; } };

  let voting = 0;
  const votes = () => attempt(async () => {
    if (!explorer.source.votes) return;
    if (voting) { explorer.source.cancel(voting); voting = 0; }
    const values = JSON.stringify(explorer.state.values);
    $("ask-votes").disabled = true;
    try {
      const begun = await explorer.source.votes(explorer.state.values);
      voting = begun.job;
      explorer.say("asking the indicators for the label …");
      await follow(begun, (verdict) => {
        if (values !== JSON.stringify(explorer.state.values)) return;
        explorer.verdict = verdict;
        explorer.say("");
        explorer.panels.label();
      }, false);
    } finally { voting = 0; $("ask-votes").disabled = false; }
  });

  const coexisting = () => attempt(async () => {
    const axis = explorer.data.controls.find((c) => c.axis) || explorer.data.controls[0], values = JSON.stringify(explorer.state.values);
    $("coexisting").textContent = "coming from below and from above …";
    $("ask-coexisting").disabled = true;
    try {
      await follow(await explorer.source.coexisting(explorer.state.values, axis.name, explorer.state.quantity), (found) => {
        if (values !== JSON.stringify(explorer.state.values)) return;
        explorer.others = {};
        const same = (a, b) => {
          const s = explorer.data.swing;
          return s.every((n) => {
            const [al, ah] = explorer.ends(a.series[n]), [bl, bh] = explorer.ends(b.series[n]), size = Math.max(ah - al, bh - bl, 1e-9 * Math.abs(ah));
            return Math.abs(al - bl) < 0.02 * size && Math.abs(ah - bh) < 0.02 * size;
          });
        };
        const says = ["up", "down"].map((way) => {
          if (!found[way]) return `${way}: ended on the way`;
          const m = explorer.panels.decoded(found[way]);
          if (same(m, explorer.shown)) return `${way}: the same motion`;
          explorer.others[way] = m;
          return `${way}: another motion, ${m.label.text}`;
        });
        $("coexisting").textContent = says.join("; ");
        explorer.panels.show();
      }, false);
    } finally { $("ask-coexisting").disabled = false; if ($("coexisting").textContent.endsWith("…")) $("coexisting").textContent = ""; }
  });

  const withoutAxes = () => Object.fromEntries(Object.entries(explorer.state.values).filter(([k]) => !explorer.control(k).axis));
  let slots = 0;
  const finer = (request, replace = false) => attempt(async () => {
    const slot = ++slots;
    for (const job of shown) explorer.source.cancel(job.job);
    await follow(await explorer.source.finer(request), (o) => {
      if (replace) explorer.overview.replace(o); else explorer.overview.add(o, slot);
    });
    explorer.stored = stored();
    if (explorer.shown) explorer.panels.label();
  });
  const zoomed = () => {
    const r = explorer.overview.ranges(), names = explorer.layers[0].axes.map((a) => a.name);
    return {values: withoutAxes(), ranges: {[names[0]]: r.x, ...(names[1] ? {[names[1]]: r.y} : {})}};
  };

  const branch = () => attempt(async () => {
    const before = explorer.branches;
    await follow(await explorer.source.branches(explorer.state.values), (found) => {
      explorer.branches = [...before, ...found];
      explorer.overview.refresh();
    });
  });

  const theme = (name) => {
    document.documentElement.dataset.theme = name;
    if (explorer.layers.length) explorer.overview.show();
    explorer.panels.show();
  };

  const begin = async () => {
    const dark = matchMedia("(prefers-color-scheme: dark)");
    document.documentElement.dataset.theme = dark.matches ? "dark" : "light";
    try { explorer.data ??= await explorer.source.load(); } catch (error) { explorer.say(error.message, true); return; }
    const {data, source} = explorer;
    document.title = `whirlmap: ${data.title}`;
    $("title").textContent = data.title;
    Object.assign(explorer.state, {quantity: data.swing[0], section: data.swing[0]}, explorer.address.read());
    explorer.overview.begin(); explorer.panels.begin(); explorer.controls.begin(); explorer.exports.begin();
    if (data.kind !== "point") {
      explorer.state.values = explorer.nearest({...explorer.overview.first(), ...explorer.state.values});
      explorer.controls.update();
      explorer.overview.show();
    }
    $("auto").checked = explorer.state.auto && data.kind === "diagram" && Boolean(source.finer);
    explorer.state.auto = $("auto").checked;
    const hide = (id, wanted) => { if (!wanted) $(id).hidden = true; };
    for (const id of ["finer", "again"]) hide(id, source.finer);
    $("auto").parentElement.hidden = !source.finer;
    hide("branch", source.branches && data.kind !== "point");
    if (data.kind === "map") $("branch").textContent = "Follow bifurcations";
    for (const id of ["ask-votes"]) hide(id, source.votes);
    $("auto-votes").parentElement.hidden = !source.votes;
    hide("ask-coexisting", source.coexisting);

    const picks = {quantity: "quantity", plane: "plane", colour: "colour", state: "section"};
    for (const [id, part] of Object.entries(picks)) {
      $(id).addEventListener("change", (e) => explorer.set({[part]: part === "plane" ? +e.target.value : e.target.value}));
    }
    const picked = () => { for (const [id, part] of Object.entries(picks)) $(id).value = explorer.state[part]; };
    explorer.listeners.push((changed) => {
      explorer.address.write(); picked();
      if (changed.has("values")) where();
      if (changed.has("values") || changed.has("quantity")) ask();
      else if (changed.has("plane") && explorer.shown) explorer.panels.orbit();
      if (changed.has("zoom") && explorer.state.zoom && explorer.state.auto) finer(zoomed());
    });
    $("auto").addEventListener("change", (e) => explorer.set({auto: e.target.checked}));
    $("auto-votes").addEventListener("change", (e) => { explorer.set({autoVotes: e.target.checked}); if (e.target.checked) votes(); });
    $("finer").addEventListener("click", () => finer(zoomed()));
    $("again").addEventListener("click", () => finer({values: withoutAxes()}, true));
    $("branch").addEventListener("click", branch);
    $("cancel").addEventListener("click", () => { for (const job of shown) explorer.source.cancel(job.job); });
    $("ask-votes").addEventListener("click", votes);
    $("ask-coexisting").addEventListener("click", coexisting);
    $("theme").addEventListener("click", () => theme(document.documentElement.dataset.theme === "dark" ? "light" : "dark"));
    dark.addEventListener("change", () => theme(dark.matches ? "dark" : "light"));
    window.addEventListener("hashchange", () => explorer.set({zoom: null, ...explorer.address.read()}));
    picked(); where(); explorer.address.write();
    ask();
    if (data.filling) attempt(async () => {
      await follow({job: data.filling, running: true, done: 0, total: 0, version: 0}, explorer.overview.replace);
      explorer.stored = stored();
      if (explorer.shown) explorer.panels.label();
    });
  };
  begin();
})();
