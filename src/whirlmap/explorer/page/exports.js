/* What leaves the page: script, commands, data, and the picture. */
"use strict";
explorer.exports = (() => {
  const {$, make} = explorer;
  const save = (blob, name) => {
    const link = make("a", "", {download: name});
    link.href = URL.createObjectURL(blob);
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  };

  /** All panels that are shown, in one picture, where they stand on the page. */
  const picture = () => {
    const plots = [...document.querySelectorAll(".uplot")].filter((p) => p.offsetParent);
    const boxes = plots.map((p) => p.getBoundingClientRect()), ratio = Math.max(devicePixelRatio, 2), pad = 12, top = 34;
    const left = Math.min(...boxes.map((b) => b.left)), up = Math.min(...boxes.map((b) => b.top));
    const right = Math.max(...boxes.map((b) => b.right)), down = Math.max(...boxes.map((b) => b.bottom));
    const canvas = document.createElement("canvas");
    canvas.width = (right - left + 2 * pad) * ratio; canvas.height = (down - up + 2 * pad + top) * ratio;
    const ctx = canvas.getContext("2d");
    ctx.scale(ratio, ratio);
    ctx.fillStyle = explorer.colour("card"); ctx.fillRect(0, 0, canvas.width, canvas.height);
    ctx.fillStyle = explorer.colour("ink"); ctx.font = "13px system-ui, sans-serif";
    ctx.fillText(`${explorer.data.case}: ${$("where").textContent} — ${$("label").textContent}`, pad, 22);
    plots.forEach((p, k) => {
      const b = boxes[k];
      ctx.drawImage(p.querySelector("canvas"), b.left - left + pad, b.top - up + pad + top, b.width, b.height);
      const title = p.closest(".card")?.querySelector("h2")?.textContent;
      if (title && !p.closest("#loads")) { ctx.fillStyle = explorer.colour("muted"); ctx.fillText(title, b.left - left + pad + 56, b.top - up + pad + top - 4); }
    });
    return new Promise((done) => canvas.toBlob(done, "image/png"));
  };

  const NAMES = {script: "motion.py", command: "commands.sh", data: "motion.csv", picture: "motion.png"};
  const give = async (kind) => {
    if (kind === "picture") return save(await picture(), NAMES.picture);
    const text = await explorer.source.export(kind, explorer.state.values);
    return save(new Blob([text], {type: "text/plain"}), NAMES[kind]);
  };

  const begin = () => {
    if (!explorer.source.export) for (const o of [...$("export").options]) if (o.value && o.value !== "picture") o.remove();
    $("export").addEventListener("change", async (event) => {
      const kind = event.target.value;
      event.target.value = "";
      if (kind) try { await give(kind); } catch (error) { explorer.say(error.message, true); }
    });
    $("link").addEventListener("click", async () => {
      try { await navigator.clipboard.writeText(location.href); explorer.say("link copied"); } catch { explorer.say(location.href); }
    });
  };
  return {begin, picture};
})();
