/* Which edition the figures show, and the diagrams that can be clicked: each is put together when it comes into view. */
"use strict";
(() => {
  const text = (id) => JSON.parse(document.getElementById(id).textContent);
  const {page, place} = text("explorer-page");

  /** A page of the explorer in a frame that is as high as what it shows. */
  const open = (box) => {
    const frame = document.createElement("iframe");
    frame.title = box.dataset.title;
    frame.addEventListener("load", () => {
      const body = frame.contentDocument.body, fit = () => {
        const height = Math.ceil(body.getBoundingClientRect().height);
        if (height) frame.style.height = `${height}px`;
      };
      new frame.contentWindow.ResizeObserver(fit).observe(body);
    });
    frame.srcdoc = page.replace(place, () => text(box.dataset.content));
    box.replaceChildren(frame);
  };
  const seen = new IntersectionObserver((entries) => {
    for (const {isIntersecting, target} of entries) if (isIntersecting) { seen.unobserve(target); open(target); }
  }, {rootMargin: "300px"});
  for (const box of document.querySelectorAll(".live")) seen.observe(box);

  const choose = (edition) => {
    for (const e of document.querySelectorAll("[data-shown]")) e.hidden = e.dataset.shown !== edition;
  };
  const choices = [...document.querySelectorAll("nav input")];
  for (const choice of choices) choice.addEventListener("change", () => choose(choice.value));
  choose(choices.find((choice) => choice.checked).value);
})();
