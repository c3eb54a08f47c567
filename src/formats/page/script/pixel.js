// What is at A and B: spectra, planes, and the numbers of the cube's band.

/** The name of a plane, and its unit. Those with names of the user's, which may end in brackets, have none. */
function parted(name) {
  const [, bare = name, unit = ""] = /^(?!ABUNDANCE |ABUNDANCE_LIT |GLOBE )(\S+) \((.*)\)$/.exec(name) || [];
  return { bare, unit };
}

/** Whether the numbers of the thermal part are of the cube's pixels or cells, so that the rest is what is reflected. */
const canSubtract = () => Boolean(page.sources.thermal) && page.sources.thermal.side === page.sources.cube.side;

/** What is missing if they are not. */
function toSubtract() {
  const { cube, thermal } = page.sources, { file, title } = cube.side > thermal.side ? cube : thermal;
  return `The reflected part needs ${file ? file.name : `the file of the ${title.toLowerCase()}`}, too.`;
}

/** The material of an index, where the report and the planes agree on how many there are. */
function material(index) {
  const named = page.report && Array.isArray(page.report.surfaces) ? page.report.surfaces : [];
  const planes = page.sources.planes.names.filter((name) => name.startsWith("ABUNDANCE ")).length;
  return named.length === planes && named[index] ? `${index}: ${named[index].name}` : shown(index);
}

async function spectra(at) {
  const { cube, thermal } = page.sources, isPart = canSubtract(), found = { cube: await cube.region(at) };
  if (thermal) found.thermal = await thermal.region(at);
  if (isPart) found.reflected = found.cube.map((m, i) => m.mean - found.thermal[i].mean);
  return found;
}

const isPixel = ([x0, y0, x1, y1]) => x0 === x1 && y0 === y1;
const placed = (at) => (isPixel(at) ? `sample ${at[0]}, line ${at[1]}` : `samples ${at[0]} to ${at[2]}, lines ${at[1]} to ${at[3]}`);

/** A plane at a place: indices have no mean, and angles that begin anew at 360 deg none that is simple. */
function ofPlane(name, m, both) {
  const { bare, unit } = parted(name);
  if (m.count && m.sd === 0) return element("td", bare === "MATERIAL" ? material(m.mean) : shown(m.mean));
  if (m.count && unit.startsWith("index")) return element("td", "several");
  return m.count && unit === "deg" && /LONGITUDE|AZIMUTH/.test(bare) ? element("td", `${rounded(m.min)} to ${rounded(m.max)}`) : both(m);
}

let asked = 0;

/** Reads and shows all that is known at A and B. */
async function readout() {
  const turn = ++asked, { cube, thermal, planes } = page.sources, names = ["a", "b"].filter((name) => page.selected[name]);
  marks();
  if (!cube || !names.length) return;
  const found = {}, told = {}, wait = setTimeout(() => by("values").replaceChildren(element("p", "reading …", "numbers")), 200);
  try {
    for (const name of names) {
      found[name] = await spectra(page.selected[name]);
      if (planes) told[name] = await planes.region(page.selected[name]);
    }
  } finally {
    clearTimeout(wait);
  }
  // A later click is shown already.
  if (turn !== asked) return;
  drawSpectra(names, found);
  const rows = [], cells = (of) => names.map((name) => of(name));
  const both = (m) => element("td", m.count > 1 ? `${rounded(m.mean)} ± ${rounded(m.sd, 3)}` : shown(m.count ? m.mean : NaN));
  rows.push(["place", ...cells((name) => element("td", placed(page.selected[name])))]);
  const band = Math.min(page.band, cube.count - 1);
  rows.push([`${page.kind === "product" ? "cube" : "value"}, ${bandName(cube, band)}`, ...cells((name) => both(found[name].cube[band]))]);
  if (planes) planes.names.forEach((name, k) => rows.push([name, ...cells((of) => ofPlane(name, told[of][k], both))]));
  by("values").replaceChildren(table(["", ...names.map((name) => name.toUpperCase())], rows));
  const note = [cube.told && `spectrum: ${cube.told}`, thermal && !canSubtract() && `thermal part: ${thermal.told || "all pixels"}`, planes && planes.told && `planes: ${planes.told}`].filter(Boolean).join("; ");
  if (note) by("values").append(element("p", note, "numbers"));
  const head = ["band", "um"], columns = [];
  for (const name of names) {
    const { cube: total, thermal: heat, reflected } = found[name], of = (label, values) => { head.push(`${name.toUpperCase()} ${label}`); columns.push(values); };
    of(isPixel(page.selected[name]) ? "value" : "mean", total.map((m) => m.mean));
    if (!isPixel(page.selected[name])) of("spread", total.map((m) => m.sd));
    if (reflected) of("reflected", reflected.map(Math.fround));
    if (heat) of("thermal", heat.map((m) => m.mean));
  }
  page.table = () => by("spectrum-table").replaceChildren(table(head, cube.names.map((_, i) => [String(i + 1), shown(cube.um[i] ?? NaN), ...columns.map((values) => shown(values[i]))])));
  if (by("spectrum-table").parentElement.open) page.table();
}

function drawSpectra(names, found) {
  const { cube } = page.sources, hasUm = cube.um.some((um) => um !== null), x = cube.um.map((um, i) => (hasUm ? um ?? NaN : i + 1)), curves = [];
  by("legend").replaceChildren();
  const add = (name, label, y, spread, colour, dash) => {
    curves.push({ name: label, x, y, spread, colour, dash });
    const said = element("span", `${dash ? "┄" : "—"} ${label}  `);
    said.style.color = colour;
    by("legend").append(said);
  };
  for (const name of names) {
    const { cube: total, thermal, reflected } = found[name], colour = `var(--${name})`, of = (ms) => ms.map((m) => m.mean), call = name.toUpperCase();
    const spread = isPixel(page.selected[name]) ? null : total.map((m) => m.sd);
    add(name, call, of(total), spread, colour);
    if (reflected) add(name, `${call} reflected`, reflected, null, colour, "6 3");
    if (thermal) add(name, `${call} thermal`, of(thermal), null, name === "a" ? "var(--heat)" : colour, "2 2");
  }
  plot(by("plot"), curves, [hasUm ? "wavelength, um" : "band", cube.unit || "value"], x[page.band]);
}
