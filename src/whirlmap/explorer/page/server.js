/* Motions from the local server that sent this page. */
"use strict";
(() => {
  const ask = async (name, body, signal) => {
    const options = body === undefined ? {} : {method: "POST", headers: {"Content-Type": "application/json"}, body: JSON.stringify(body)};
    let answer;
    try {
      answer = await fetch(name, {...options, signal});
    } catch (error) {
      if (error.name === "AbortError") throw error;
      throw new Error("the server does not answer: was it ended?");
    }
    const found = await answer.json();
    if (!answer.ok) throw new Error(found.error);
    return found;
  };
  explorer.source = {
    load: () => ask("data"),
    state: () => ask("state"),
    motion: (values, quantity, signal) => ask("motion", {values, quantity}, signal),
    votes: (values) => ask("votes", {values}),
    finer: (request) => ask("finer", request),
    coexisting: (values, along, quantity) => ask("coexisting", {values, along, quantity}),
    branches: (values) => ask("branches", {values}),
    job: (job, version) => ask("job", {job, version}),
    cancel: (job) => ask("cancel", {job}),
    export: async (kind, values) => (await ask("export", {kind, values})).text,
  };
})();
