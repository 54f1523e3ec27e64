/* The controls beside the view. */

function setLayer(view, number, layer, on) {
  if (view.from && ALONE.includes(layer)) view.kept[number][layer] = on;
  view.sensors[number].layers[layer].visible = on;
}

/* The check box of a column follows the check boxes below it. */
function followColumn(view, layer) {
  const own = view.root.querySelectorAll(`input[data-sensor][data-layer="${layer}"]`);
  const all = view.root.querySelector(`input[data-all="${layer}"]`);
  const on = [...own].filter((box) => box.checked).length;
  if (!all) return;
  all.checked = on === own.length;
  all.indeterminate = on > 0 && on < own.length;
}

function onSwitch(view, box) {
  const { sensor, layer, all } = box.dataset;
  if (all) {
    for (const own of view.root.querySelectorAll(`input[data-sensor][data-layer="${all}"]`)) {
      own.checked = box.checked;
      setLayer(view, Number(own.dataset.sensor), all, box.checked);
    }
    return;
  }
  if (sensor !== undefined) {
    setLayer(view, Number(sensor), layer, box.checked);
    followColumn(view, layer);
  }
  if (box.dataset.body !== undefined && view.body) makeSeeThrough(view.body, box.checked);
}

function chooseMap(view, name) {
  view.maps.forEach(({ map, mesh }) => { mesh.visible = map.name === name; });
  const chosen = view.maps.find(({ map }) => map.name === name);
  view.legend.replaceChildren(...(chosen ? [legendOf(chosen.map.legend)] : []));
  view.legend.hidden = !chosen;
}

function listenToPanel(view) {
  const { root } = view;
  root.addEventListener("change", (event) => {
    const box = event.target;
    if (box.matches("input[type=checkbox]")) onSwitch(view, box);
    if (box.matches("select[data-map]")) chooseMap(view, box.value);
    view.draw();
  });
  root.addEventListener("click", (event) => {
    const button = event.target.closest("button[data-view], button[data-look]");
    if (!button) return;
    if (button.dataset.view) view.show(button.dataset.view);
    else view.look(Number(button.dataset.look));
  });
}

/* Apply the controls at the start: a browser may have restored them from the last visit. */
function startAsSwitched(view) {
  for (const box of view.root.querySelectorAll("input[data-sensor]")) onSwitch(view, box);
  const body = view.root.querySelector("input[data-body]");
  if (body && body.checked) onSwitch(view, body);
  const map = view.root.querySelector("select[data-map]");
  if (map) chooseMap(view, map.value);
}
