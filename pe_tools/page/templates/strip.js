for (const box of document.querySelectorAll("[data-strip]")) {
  const [start, end, left, right, first] = box.dataset.strip.split(" ").map(Number);
  const svg = box.querySelector("svg");
  const film = box.querySelector("video");
  const height = svg.viewBox.baseVal.height;
  const added = (name) => svg.appendChild(document.createElementNS(svg.namespaceURI, name));
  const line = added("line");
  const told = added("text");
  line.setAttribute("class", "cursor");
  told.setAttribute("text-anchor", "middle");
  const show = (time) => {
    const x = left + (time - start) / (end - start) * (right - left);
    for (const [name, value] of Object.entries({x1: x, x2: x, y1: 30, y2: height - 34})) {
      line.setAttribute(name, value);
    }
    told.setAttribute("x", x);
    told.setAttribute("y", height - 2);
    told.textContent = `${time.toFixed(1)} s`;
  };
  const follow = (event) => {
    const place = svg.getBoundingClientRect();
    const x = (event.clientX - place.left) / place.width * svg.viewBox.baseVal.width;
    const time = start + (x - left) / (right - left) * (end - start);
    const shown = Math.min(Math.max(time, start), end);
    show(shown);
    if (film) {
      film.pause();
      film.currentTime = Math.max(shown - first, 0);
    }
  };
  svg.addEventListener("pointerdown", follow);
  svg.addEventListener("pointermove", follow);
  const play = () => {
    show(Math.min(first + film.currentTime, end));
    if (!film.paused) requestAnimationFrame(play);
  };
  film?.addEventListener("play", play);
}
