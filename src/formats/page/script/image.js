// The image, its marks, its scale and its histogram.

/** Which cells of an image are sky: those in which the planes show nothing; if those are coarser than it, those without a number other than 0. */
async function skyOf(source, bands) {
  const { cube, planes } = page.sources, covers = planes ? [...planes.names.keys()].filter((k) => parted(planes.names[k]).bare === "COVERAGE" || planes.names[k].startsWith("GLOBE ")) : [];
  if (!covers.length) return null;
  const sky = new Uint8Array(source.across * source.down).fill(1);
  if (planes.side > source.side) {
    // Parts of the cube are 0 on the ground, too.
    const of = canSubtract() ? cube : source;
    for (const band of bands) (await of.plane(band)).forEach((value, i) => { if (value) sky[i] = 0; });
    return sky;
  }
  const span = (cell, whole) => [Math.floor(cell * planes.side / source.side), Math.floor((Math.min((cell + 1) * planes.side, whole) - 1) / source.side)];
  for (const band of covers) (await planes.plane(band)).forEach((share, i) => {
    if (!(share > 0)) return;
    const [top, bottom] = span(Math.floor(i / planes.across), source.rows), [left, right] = span(i % planes.across, source.columns);
    for (let y = top; y <= bottom; y++) sky.fill(0, y * source.across + left, y * source.across + right + 1);
  });
  return sky;
}

async function decoded(png) {
  const image = new Image();
  image.src = `data:image/png;base64,${png}`;
  await image.decode();
  return image;
}

function picture(image) {
  sized(image.naturalWidth, image.naturalHeight);
  by("image").getContext("2d").drawImage(image, 0, 0);
}

function sized(columns, rows) {
  const canvas = by("image");
  [canvas.width, canvas.height] = [columns, rows];
  fit();
}

/** As large as there is room; pictures with text that stand alone at most as they are. */
function fit() {
  const canvas = by("image"), room = by("holder").getBoundingClientRect(), [columns, rows] = page.size || [canvas.width, canvas.height];
  const scale = Math.min(room.width / columns, page.size ? room.height / rows : 1);
  by("frame").style.width = `${Math.max(columns * scale, 1)}px`;
  by("frame").style.height = `${Math.max(rows * scale, 1)}px`;
  marks();
}

/** Draws planes, one in colours of a map or three as red, green and blue, each by a stretch. */
function planes(source, values, stretches, sky, map) {
  sized(source.across, source.down);
  const context = by("image").getContext("2d"), pixels = context.createImageData(source.across, source.down), of = pixels.data;
  for (let i = 0; i < values[0].length; i++) {
    if ((sky && sky[i]) || values.some((plane) => !Number.isFinite(plane[i]))) continue;
    const greys = values.map((plane, k) => (stretches[k] ? grey(stretches[k], plane[i]) : 0));
    of.set(greys.length === 3 ? greys : colour(map, greys[0]), 4 * i);
    of[4 * i + 3] = 255;
  }
  context.putImageData(pixels, 0, 0);
}

function scale(stretch, unit, map) {
  by("scale").style.visibility = stretch ? "visible" : "hidden";
  if (!stretch) return;
  const context = by("bar").getContext("2d"), { black, white } = stretch;
  for (let x = 0; x < 512; x++) {
    const [r, g, b] = colour(map, grey(stretch, black + (x + 0.5) / 512 * (white - black)));
    context.fillStyle = `rgb(${r},${g},${b})`;
    context.fillRect(x, 0, 1, 12);
  }
  [by("low").textContent, by("high").textContent, by("unit").textContent] = [rounded(black, 4), rounded(white, 4), unit || ""];
}

function histogram(ordered, stretch) {
  const canvas = by("histogram"), context = canvas.getContext("2d"), { width, height } = canvas;
  context.clearRect(0, 0, width, height);
  if (!ordered.length || !stretch) return;
  const low = ordered[0], span = ordered[ordered.length - 1] - low || 1, bins = new Array(96).fill(0), ink = getComputedStyle(document.body);
  for (const v of ordered) bins[Math.min(95, Math.floor((v - low) / span * 96))]++;
  const most = Math.max(...bins);
  context.fillStyle = ink.getPropertyValue("--soft");
  bins.forEach((count, i) => context.fillRect(i * width / 96, height - count / most * (height - 6), width / 96 - 1, height));
  context.fillStyle = ink.getPropertyValue("--a");
  for (const at of [stretch.black, stretch.white]) context.fillRect(Math.min(Math.max((at - low) / span, 0), 1) * (width - 2), 0, 2, height);
}

/** Frames around A and B. */
function marks() {
  const canvas = by("marks"), box = by("frame").getBoundingClientRect(), dots = window.devicePixelRatio || 1;
  [canvas.width, canvas.height] = [box.width * dots, box.height * dots];
  if (!page.size) return;
  const context = canvas.getContext("2d"), ink = getComputedStyle(document.body), by_pixel = canvas.width / page.size[0];
  for (const name of ["a", "b"]) {
    const at = page.selected[name];
    if (!at) continue;
    const [x0, y0, x1, y1] = at, grow = Math.max(0, (9 * dots - by_pixel) / 2) * (x0 === x1 && y0 === y1);
    for (const [wide, style] of [[4, "#000a"], [2, ink.getPropertyValue(`--${name}`)]]) {
      [context.lineWidth, context.strokeStyle] = [wide * dots, style];
      context.strokeRect(x0 * by_pixel - grow, y0 * by_pixel - grow, (x1 - x0 + 1) * by_pixel + 2 * grow, (y1 - y0 + 1) * by_pixel + 2 * grow);
    }
  }
}
