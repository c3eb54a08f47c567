// The page begins.

const page = { ...JSON.parse(by("about").textContent), sources: {}, embedded: {}, selected: { a: null, b: null }, band: 0, rgb: [0, 0, 0], size: null };

/** Says what goes wrong where it is seen. */
function told(promise) {
  return promise.catch((error) => { by("coarse").textContent = `Not done: ${error.message}`; });
}

async function begin() {
  by("title").textContent = page.title;
  by("foot").textContent = `Made by mmxrt ${page.mmxrt}. This page holds all that it shows; it loads nothing.`;
  for (const stack of page.stacks) page.sources[stack.key] = page.embedded[stack.key] = new Embedded(stack);
  const { cube } = page.sources;
  document.body.classList.toggle("plain", !cube && !page.spectra.length);
  document.body.classList.toggle("curves", page.spectra.length > 0);
  document.body.classList.toggle("texts", !cube && !page.spectra.length && !page.pictures.length);
  if (cube) {
    page.size = [cube.columns, cube.rows];
    by("facts").textContent = `${cube.columns} × ${cube.rows} pixels, ${cube.count} band${cube.count === 1 ? "" : "s"}${cube.unit ? `, ${cube.unit}` : ""}`;
    by("file-label").hidden = !cube.file;
  } else by("facts").textContent = page.kind;
  listLayers();
  listBands();
  if (cube && !page.pictures.length && cube.colours.length === 3) by("layer").value = "rgb";
  listen();
  tellCoarse();
  tellGeometry();
  if (cube || page.pictures.length) await show();
  performance.mark("first picture");
  if (page.spectra.length) {
    const inks = ["var(--a)", "var(--b)", "var(--heat)", "#2a8a4a", "#8757c9", "#8a7a10"];
    const curves = page.spectra.map((s, i) => ({ name: s.name, x: s.um, y: s.values.map((v) => v ?? NaN), colour: inks[i % inks.length] }));
    by("values").previousElementSibling.hidden = true;
    plot(by("plot"), curves, ["wavelength, um", "value"], NaN);
    for (const [i, c] of curves.entries()) { const said = element("span", `— ${c.name}  `); said.style.color = inks[i % inks.length]; by("legend").append(said); }
    page.table = () => by("spectrum-table").replaceChildren(table(["curve", "um", "value"], curves.flatMap((c) => c.x.map((x, i) => [c.name, shown(x), shown(c.y[i])]))));
  }
  tellReport();
  // So that the first click need not wait.
  for (const stack of Object.values(page.embedded)) await stack.ready();
}

told(begin());
