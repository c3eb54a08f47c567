// The choices at the side.

function bandName(source, band) {
  const parts = [];
  if (source.names[band]) parts.push(source.names[band]);
  if (Number.isFinite(source.um[band])) parts.push(`${rounded(source.um[band], 6)} um`);
  return parts.length ? parts.join(", ") : `band ${band + 1}`;
}

function listLayers() {
  const { cube, thermal, planes } = page.sources, select = by("layer"), chosen = select.value;
  select.replaceChildren();
  const group = (label) => { const made = document.createElement("optgroup"); made.label = label; select.append(made); return made; };
  const option = (to, value, text) => { const made = element("option", text); made.value = value; to.append(made); };
  if (page.pictures.length) { const of = group("Pictures"); page.pictures.forEach((p, i) => option(of, `picture ${i}`, p.title)); }
  if (cube) {
    const of = group("Numbers");
    option(of, "cube", cube.title);
    if (cube.count > 1) option(of, "rgb", "Three bands as colours");
    if (thermal) option(of, "thermal", "Thermal part");
    if (canSubtract()) option(of, "reflected", "Reflected part");
  }
  if (planes) { const of = group("Backplanes"); planes.names.forEach((name, i) => option(of, `plane ${i}`, name)); }
  if (chosen) select.value = chosen;
  // It was the reflected part, and is none now.
  if (!select.value) select.value = "cube";
}

function listBands() {
  const { cube } = page.sources;
  if (!cube) return;
  by("band").max = cube.count - 1;
  page.band = cube.colours[cube.colours.length === 3 ? 1 : 0] || 0;
  page.rgb = cube.colours.length === 3 ? [...cube.colours] : [0, 0, 0].map((_, k) => Math.round((2 - k) / 2 * (cube.count - 1)));
  by("band").value = page.band;
  ["red", "green", "blue"].forEach((name, k) => {
    const label = element("label", `${name} `), said = element("output"), input = element("input");
    [input.type, input.min, input.max, input.id] = ["range", 0, cube.count - 1, name];
    input.value = page.rgb[k];
    const tell = () => { said.textContent = bandName(page.sources.cube, page.rgb[k]); };
    input.addEventListener("input", () => { page.rgb[k] = Number(input.value); tell(); told(show()); });
    tell();
    label.append(said, input);
    by("rgb-row").append(label);
  });
}

/** Draws the chosen layer. */
let drawn = 0;
async function show() {
  const turn = ++drawn, layer = by("layer").value, [kind, number] = layer.split(" "), { cube, thermal } = page.sources;
  by("band-row").hidden = !cube || !["cube", "thermal", "reflected"].includes(kind);
  by("rgb-row").hidden = kind !== "rgb";
  by("stretch-row").hidden = kind === "picture";
  by("map-label").hidden = kind === "rgb";
  if (kind === "picture") {
    const { title, png } = page.pictures[Number(number)], image = await decoded(png);
    if (turn !== drawn) return;
    picture(image);
    scale(null);
    by("image").setAttribute("aria-label", title);
    return;
  }
  const source = kind === "plane" ? page.sources.planes : kind === "thermal" ? thermal : cube;
  const bands = kind === "rgb" ? page.rgb : [kind === "plane" ? Number(number) : page.band];
  by("band-name").textContent = bandName(cube, page.band);
  const values = [];
  for (const band of bands) values.push(await source.plane(band));
  if (kind === "reflected") {
    const heat = await thermal.plane(page.band);
    values[0] = values[0].map((v, i) => v - heat[i]);
  }
  const sky = kind === "plane" ? null : await skyOf(source, bands);
  // A later choice is drawn already.
  if (turn !== drawn) return;
  const ordered = values.map((plane) => sorted(plane, sky)), mode = by("stretch").value, typed = [Number(by("black").value), Number(by("white").value)];
  const own = mode === "own" && kind !== "rgb" && typed.every(Number.isFinite) ? { black: typed[0], white: typed[1] } : null;
  const stretches = ordered.map((of) => stretchOf(mode, of, own)), map = by("map").value;
  planes(source, values, stretches, sky, map);
  const single = stretches.length === 1 ? stretches[0] : null, unit = kind === "plane" ? parted(source.names[bands[0]]).unit : source.unit;
  scale(single, unit, map);
  if (single && mode !== "own") [by("black").value, by("white").value] = [shown(single.black), shown(single.white)];
  histogram(ordered[0], stretches[0]);
  const m = moments(ordered[0]), away = values[0].length - m.count;
  by("layer-statistics").textContent = m.count ? `least ${rounded(m.min)}, mean ${rounded(m.mean)}, most ${rounded(m.max)}; spread ${rounded(m.sd, 3)}${away ? `; ${away} of ${values[0].length} without data or sky` : ""}` : "no data: all is sky or empty";
  by("image").setAttribute("aria-label", `${by("layer").selectedOptions[0].textContent}, ${bands.map((band) => bandName(source, band)).join(" / ")}`);
}

/** Clicks, drags and keys on the image. */
function listen() {
  const canvas = by("image");
  let from = null;
  const pixel = (event) => {
    const box = canvas.getBoundingClientRect(), [columns, rows] = page.size;
    const at = (share, whole) => Math.min(Math.max(Math.floor(share * whole), 0), whole - 1);
    return [at((event.clientX - box.left) / box.width, columns), at((event.clientY - box.top) / box.height, rows)];
  };
  const select = (name, [x, y], [u, v]) => { page.selected[name] = [Math.min(x, u), Math.min(y, v), Math.max(x, u), Math.max(y, v)]; };
  canvas.addEventListener("pointerdown", (event) => { if (page.size) { from = pixel(event); canvas.setPointerCapture(event.pointerId); } });
  canvas.addEventListener("pointermove", (event) => { if (from) { select(event.shiftKey ? "b" : "a", from, pixel(event)); marks(); } });
  canvas.addEventListener("pointerup", (event) => { if (from) { select(event.shiftKey ? "b" : "a", from, pixel(event)); from = null; told(readout()); } });
  canvas.addEventListener("pointercancel", () => { if (from) { from = null; told(readout()); } });
  canvas.addEventListener("keydown", (event) => {
    const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (!way || !page.size) return;
    event.preventDefault();
    const [x, y] = page.selected.a || page.size.map((n) => Math.floor(n / 2));
    const to = [x, y].map((v, k) => Math.min(Math.max(v + way[k], 0), page.size[k] - 1));
    select("a", to, to);
    told(readout());
  });
  document.addEventListener("keydown", (event) => {
    const step = { "[": -1, "]": 1 }[event.key];
    if (!step || !page.sources.cube || event.target.matches("input[size], select")) return;
    by("band").value = page.band + step;
    by("band").dispatchEvent(new Event("input"));
  });
  by("band").addEventListener("input", () => { page.band = Number(by("band").value); told(show()); told(readout()); });
  for (const id of ["layer", "stretch", "map"]) by(id).addEventListener("change", () => told(show()));
  for (const id of ["black", "white"]) by(id).addEventListener("change", () => { by("stretch").value = "own"; told(show()); });
  by("spectrum-table").parentElement.addEventListener("toggle", () => page.table && page.table());
  new ResizeObserver(fit).observe(by("holder"));
  by("file").addEventListener("change", () => { told(opened([...by("file").files])); by("file").value = ""; });
  document.addEventListener("dragover", (event) => event.preventDefault());
  document.addEventListener("drop", (event) => { event.preventDefault(); told(opened([...event.dataTransfer.files])); });
}

/** Whether a file holds the numbers that the page holds: in the cell that is brightest in the band shown, to single precision. */
async function isSame(full, embedded) {
  const { side, across, columns, rows } = embedded, plane = await embedded.plane(page.band);
  const brightest = plane.reduce((best, v, i) => (Number.isFinite(v) && !(Math.abs(v) <= Math.abs(plane[best])) ? i : best), 0);
  const [x, y] = [brightest % across * side, Math.floor(brightest / across) * side], at = [x, y, Math.min(x + side, columns) - 1, Math.min(y + side, rows) - 1];
  const [found, wanted] = [await full.region(at), await embedded.region(at)];
  return wanted.every((m, band) => !m.count || Math.abs(found[band].mean - m.mean) <= 1e-6 * (Math.abs(m.mean) + found[band].sd));
}

/** Takes files of whole cubes, with headers or without, in place of what is in the page. */
async function opened(files) {
  const headers = files.filter((file) => /\.hdr$/i.test(file.name)), stem = (name) => name.replace(/(\.hdr|\.[a-z]+)$/i, "").toLowerCase(), found = {};
  if (headers.length && headers.length === files.length) throw new Error(`${headers[0].name} is a header: give the file that it is of, too`);
  for (const file of files.filter((file) => !headers.includes(file))) {
    const key = /thermal/i.test(file.name) && page.embedded.thermal ? "thermal" : "cube", embedded = page.embedded[key], own = headers.find((h) => stem(h.name) === stem(file.name)) || (headers.length === 1 ? headers[0] : null);
    if (!embedded) throw new Error("this page has no cube to compare it with");
    const layout = own ? header(await own.text()) : embedded.file;
    if (!layout) throw new Error(`${file.name}: give its header (.hdr), too`);
    found[key] = new FullCube(file, embedded, layout);
    if (!await isSame(found[key], embedded)) throw new Error(`${file.name} holds other numbers than the ${embedded.title.toLowerCase()} of this page${own ? "" : ", or holds them in another layout: then give its header (.hdr), too"}`);
  }
  Object.assign(page.sources, found);
  tellCoarse();
  listLayers();
  if (by("layer").value.startsWith("picture")) by("layer").value = "cube";
  await show();
  await readout();
}
