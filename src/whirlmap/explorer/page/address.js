/* The address holds the whole state: a link shows another person the same. */
"use strict";
explorer.address = (() => {
  const range = (r) => r.join(":");

  const text = () => {
    const s = explorer.state, out = new URLSearchParams();
    for (const [k, v] of Object.entries(s.values)) out.set(`v.${k}`, v);
    out.set("show", s.quantity);
    if (s.plane) out.set("orbit", s.plane);
    if (s.colour !== "regime") out.set("colour", s.colour);
    if (s.section) out.set("state", s.section);
    if (s.zoom) { out.set("x", range(s.zoom.x)); if (s.zoom.y) out.set("y", range(s.zoom.y)); }
    return out.toString();
  };

  /** State that the address asks for; what is unknown or no number is left out. */
  const read = () => {
    const given = new URLSearchParams(location.hash.slice(1)), values = {}, found = {};
    for (const [k, v] of given) {
      const name = k.startsWith("v.") ? k.slice(2) : "";
      const c = name && explorer.control(name);
      if (c?.choices) { if (c.choices.includes(v)) values[name] = v; } else if (c && v.trim() && Number.isFinite(+v)) values[name] = +v;
    }
    const ends = (k) => {
      const r = (given.get(k) || "").split(":").map(Number);
      return r.length === 2 && r.every(Number.isFinite) && r[0] < r[1] ? r : null;
    };
    found.values = values;
    if (explorer.quantityOf(given.get("show"))) found.quantity = given.get("show");
    if (explorer.data.planes[given.get("orbit")]) found.plane = +given.get("orbit");
    if (given.get("colour")) found.colour = given.get("colour");
    if (explorer.quantityOf(given.get("state"))) found.section = given.get("state");
    const x = ends("x"), y = ends("y");
    found.zoom = x && (y || explorer.data.kind !== "map") ? {x, ...(y ? {y} : {})} : null;
    return found;
  };

  const write = () => {
    const hash = `#${text()}`;
    if (hash !== location.hash) history.replaceState(null, "", hash);
  };
  return {read, write};
})();
