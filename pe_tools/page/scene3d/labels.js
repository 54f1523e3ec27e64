/* Names over the view, as buttons; labels that would overlap are moved up. */

const RISE = 26, GAP = 3, LONGEST = 28;

let texts = {};  // of the page; all views of a page have the same

function textWith(key, name) {
  return texts[key].replace("{name}", () => name);
}

function shortened(name) {
  return name.length > LONGEST ? `${name.slice(0, LONGEST - 1)}…` : name;
}

function sensorLabel(sensor, onClick) {
  const label = element("button", "v3-label", shortened(sensor.name));
  label.type = "button";
  label.tabIndex = -1;  // keyboards reach the same button in the table
  label.style.setProperty("--tint", sensor.color);
  label.title = textWith("look_from", sensor.name);
  label.addEventListener("click", onClick);
  return { label, at: new T.Vector3(...sensor.at), rise: RISE };
}

function groundLabel(words) {
  const label = element("span", "v3-word", words.text);
  return { label, at: new T.Vector3(...words.at), rise: 0 };
}

function onScreen(at, camera, width, height) {
  const place = at.clone().project(camera);
  const seen = place.z > -1 && place.z < 1;
  return { x: (place.x + 1) / 2 * width, y: (1 - place.y) / 2 * height, seen };
}

const overlaps = (a, b) =>
  a.x < b.x + b.w + GAP && b.x < a.x + a.w + GAP && a.y < b.y + b.h + GAP && b.y < a.y + a.h + GAP;

/* Move a box up until it is clear of all others; return false if there is no room. */
function settle(box, taken) {
  for (let tries = 0; tries < 12; tries += 1) {
    const other = taken.find((each) => overlaps(box, each));
    if (!other) return true;
    box.y = other.y - box.h - GAP;
  }
  return false;
}

function placeLabel(item, box, place) {
  item.label.hidden = false;
  item.label.style.transform = `translate(${Math.round(box.x)}px, ${Math.round(box.y)}px)`;
  item.label.style.setProperty("--lead", `${Math.max(0, Math.round(place.y - box.y - box.h))}px`);
  item.label.style.setProperty("--lead-x", `${Math.round(place.x - box.x)}px`);
}

/* Place labels: text on the ground gives way to names of sensors. */
function placeLabels(items, camera, width, height) {
  const taken = [];
  const near = items.map((item) => ({ item, place: onScreen(item.at, camera, width, height) }));
  near.sort((a, b) => Number(b.item.rise > 0) - Number(a.item.rise > 0) || b.place.y - a.place.y);
  for (const { item, place } of near) {
    item.label.hidden = !place.seen || item.off === true;
    if (item.label.hidden) continue;
    const w = item.label.offsetWidth, h = item.label.offsetHeight;
    const x = Math.min(Math.max(place.x - w / 2, 2), width - w - 2);
    const box = { x, y: place.y - h - item.rise + (item.rise ? 0 : h / 2), w, h };
    const fits = item.rise ? settle(box, taken) : !taken.some((each) => overlaps(box, each));
    const inside = box.y > 0 && box.y + h < height && place.x > 0 && place.x < width;
    item.label.hidden = !fits || !inside;
    if (item.label.hidden) continue;
    taken.push(box);
    placeLabel(item, box, place);
  }
}
