"use strict";
(() => {
  const byId = (id) => document.getElementById(id);
  const all = (selector, from = document) => [...from.querySelectorAll(selector)];

  // The wipe: two pictures over each other, the upper one (right) cut where the line is.
  const cards = byId("cards");
  if (cards) {
    const [left, right, zoom, wipe, under, over, split] =
      ["left", "right", "zoom", "wipe", "under", "over", "split"].map(byId);
    let place = 0.5;
    let held = false;
    const cut = () => {
      const shown = held ? 1 : place;
      over.style.clipPath = `inset(0 0 0 ${shown * 100}%)`;
      split.style.left = `${shown * 100}%`;
      wipe.setAttribute("aria-valuenow", Math.round(place * 100));
    };
    const size = () => {
      const times = Number(zoom.value);
      for (const image of [under, over]) {
        image.style.width = image.naturalWidth ? `${image.naturalWidth * times}px` : "";
      }
      wipe.classList.toggle("near", times > 1);
    };
    const figures = () => all(`figure[data-kind="${cards.dataset.kind}"]`, cards);
    const show = () => {
      const list = figures();
      for (const [select, image] of [[left, under], [right, over]]) {
        const figure = list.find((figure) => figure.dataset.name === select.value) ?? list[0];
        image.src = figure.querySelector("img").src;
        image.alt = figure.dataset.name;
      }
      cut();
    };
    const choose = (kind) => {
      cards.dataset.kind = kind;
      for (const button of all(".kinds button")) {
        button.setAttribute("aria-pressed", String(button.dataset.kind === kind));
      }
      const names = figures().map((figure) => figure.dataset.name);
      // The first method is often the one without shadows, which says little.
      for (const [select, otherwise] of [[left, 0], [right, 2]]) {
        const before = select.value;
        select.replaceChildren(...names.map((name) => new Option(name, name)));
        select.value = names.includes(before) ? before : names[Math.min(otherwise, names.length - 1)];
      }
      show();
    };
    const drag = (event) => {
      const box = wipe.getBoundingClientRect();
      place = Math.min(1, Math.max(0, (event.clientX - box.left) / box.width));
      cut();
    };
    wipe.addEventListener("pointerdown", (event) => {
      wipe.setPointerCapture(event.pointerId);
      drag(event);
    });
    wipe.addEventListener("pointermove", (event) => {
      if (event.buttons & 1) drag(event);
    });
    wipe.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: -0.02, ArrowRight: 0.02, Home: -1, End: 1 }[event.key];
      if (step) {
        place = Math.min(1, Math.max(0, place + step));
        event.preventDefault();
        cut();
      }
    });
    const hold = (down) => (event) => {
      if (event.key === "f" && !event.ctrlKey && !event.metaKey && event.target.tagName !== "SELECT") {
        held = down;
        cut();
      }
    };
    addEventListener("keydown", hold(true));
    addEventListener("keyup", hold(false));
    // Small pictures are seen twice as large from the start.
    const first = cards.querySelector("img");
    const grow = () => {
      if (first.naturalWidth * 2 <= wipe.parentElement.clientWidth) zoom.value = "2";
      size();
    };
    if (first.complete) grow(); else first.addEventListener("load", grow);
    for (const image of [under, over]) image.addEventListener("load", size);
    for (const select of [left, right]) select.addEventListener("change", show);
    zoom.addEventListener("change", size);
    for (const button of all(".kinds button")) {
      button.addEventListener("click", () => choose(button.dataset.kind));
    }
    for (const image of all("img", cards)) {
      image.addEventListener("click", () => {
        right.value = image.closest("figure").dataset.name;
        show();
        wipe.scrollIntoView({ block: "center" });
      });
    }
    choose(all(".kinds button")[0].dataset.kind);
  }

  // A click on a heading sorts, a second one the other way; what has no number comes last.
  for (const table of all("table:not(.times)")) {
    const body = table.tBodies[0];
    const headings = all("thead tr:last-child th", table);
    headings.forEach((heading, column) => heading.addEventListener("click", () => {
      const down = heading.getAttribute("aria-sort") === "ascending";
      headings.forEach((other) => other.removeAttribute("aria-sort"));
      heading.setAttribute("aria-sort", down ? "descending" : "ascending");
      const key = (row) => {
        const cell = row.cells[column];
        if (!cell) return [1, 0];
        if (cell.tagName === "TH") return [0, cell.textContent];
        return cell.dataset.v === undefined ? [1, 0] : [0, Number(cell.dataset.v)];
      };
      const rows = [...body.rows].map((row) => [key(row), row]);
      rows.sort(([[a, x]], [[b, y]]) => a - b || (x < y ? -1 : x > y ? 1 : 0) * (down ? -1 : 1));
      body.append(...rows.map(([, row]) => row));
    }));
  }

  // A lane below a probe lifts its curve.
  for (const plot of all("svg.plot")) {
    for (const lane of all(".lane", plot)) {
      const light = (on) => () => {
        plot.classList.toggle("lit", on);
        for (const line of all(".line", plot)) {
          line.classList.toggle("on", on && line.dataset.m === lane.dataset.m);
        }
      };
      lane.addEventListener("pointerenter", light(true));
      lane.addEventListener("pointerleave", light(false));
    }
  }

  // What became of the page, for those who test it.
  addEventListener("load", () => {
    const root = document.documentElement;
    const pictures = all("img");
    const broken = pictures.filter((image) => !(image.complete && image.naturalWidth > 0));
    root.dataset.pictures = pictures.length;
    root.dataset.broken = broken.length;
    root.dataset.height = root.scrollHeight;
    root.dataset.state = "ready";
  });
})();
