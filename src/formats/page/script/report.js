// What the report says, the geometry, and what the page is.

function listed(title, items, kind) {
  const box = element("div");
  box.append(element("h2", title));
  const list = element("ul");
  for (const item of items) list.append(element("li", item, kind));
  box.append(list);
  by("report").append(box);
}

function boxed(title, ...inside) {
  const box = element("div");
  box.append(element("h2", title), ...inside);
  by("report").append(box);
}

const entries = (of) => (Array.isArray(of) ? of.filter((item) => item && typeof item === "object") : []);
const strings = (of) => (Array.isArray(of) ? of.filter((item) => typeof item === "string") : []);

function tellReport() {
  const { report } = page, warnings = [...strings(report && report.warnings), ...page.warnings];
  if (warnings.length) listed(`Warnings (${warnings.length})`, warnings, "warning");
  for (const of of page.tables) boxed(of.title, table(of.head, of.rows, "texts"));
  for (const of of page.texts) boxed(of.title, element("pre", of.text));
  if (!report) return;
  const effects = entries(report.effects);
  if (effects.length) boxed("Effects", table(["effect", "", "because"], effects.map((e) => [e.name, e.decision, e.because]), "texts"));
  const statistics = entries(report.statistics);
  if (statistics.length) boxed("Statistics of the report, over all pixels", table(["", "least", "mean", "most", "unit"], statistics.map((s) => [s.name, ...[s.min, s.mean, s.max].map((v) => rounded(v)), s.unit])));
  const surfaces = entries(report.surfaces);
  if (surfaces.length) boxed("Materials", table(["", "model", "geometric albedo", "Bond albedo"], surfaces.map((s) => [s.name, s.model, rounded(s.geometric_albedo, 4), rounded(s.bond_albedo, 4)])));
  const checks = entries(report.checks);
  if (checks.length) boxed("Checks", table(["", "value", "limit"], checks.map((c) => [c.name, rounded(c.value, 3), rounded(c.limit, 3)])));
  if (strings(report.defaults).length) listed("Values that the scene left open", strings(report.defaults));
  if (entries(report.inputs).length) listed("Inputs", entries(report.inputs).map((i) => `${i.path} (BLAKE3 ${String(i.blake3).slice(0, 12)}…)`));
}

/** Arrows to north and the Sun, and the angles in the middle of the image. */
function tellGeometry() {
  const of = page.report && page.report.orientation, holder = by("geometry");
  if (!of || typeof of !== "object") { holder.hidden = true; return; }
  const svg = shape("svg", { viewBox: "-50 -50 100 100", width: 132, role: "img", "aria-label": "Directions in the image" });
  svg.append(shape("rect", { x: -30, y: -30, width: 60, height: 60, fill: "none", stroke: "var(--line)" }), shape("circle", { r: 1.5, fill: "var(--soft)" }));
  const arrow = (angle, sign, ink) => {
    if (!Number.isFinite(angle)) return;
    const a = angle * Math.PI / 180, [x, y] = [Math.sin(a), -Math.cos(a)], [u, v] = [-y, x];
    svg.append(shape("path", { d: `M0 0L${32 * x} ${32 * y}M${26 * x + 4 * u} ${26 * y + 4 * v}L${32 * x} ${32 * y}L${26 * x - 4 * u} ${26 * y - 4 * v}`, stroke: ink, fill: "none", "stroke-width": 1.6 }));
    svg.append(shape("text", { x: 41 * x, y: 41 * y + 4, "text-anchor": "middle" }, sign));
  };
  arrow(of.north_deg, "N", "var(--a)");
  arrow(of.sun_deg, "☉", "var(--b)");
  arrow(of.mars_deg, "♂", "var(--heat)");
  const degrees = (angle) => `${Number(angle.toFixed(1))}°`;
  const said = [Number.isFinite(of.north_deg) ? `north ${degrees(of.north_deg)}` : "north along the line of sight", Number.isFinite(of.sun_deg) ? `Sun ${degrees(of.sun_deg)}` : "Sun along the line of sight"];
  if (Number.isFinite(of.mars_deg)) said.push(`Mars ${degrees(of.mars_deg)}`);
  const view = Array.isArray(of.view) && of.view.every(Number.isFinite) ? `; the camera looks along (${of.view.map((v) => String(Number(v.toFixed(3)))).join(", ")}) in the body's axes` : "";
  holder.replaceChildren(svg, element("figcaption", `Clockwise from up: ${said.join(", ")}${view}`));
}

function tellCoarse() {
  const { cube, thermal, planes } = page.sources, cubes = [cube, thermal].filter(Boolean), side = (s) => `${s.side} × ${s.side}`, said = [];
  const coarse = cubes.filter((of) => of.side > 1), files = coarse.flatMap((of) => (of.file ? [of.file.name] : []));
  if (coarse.length) said.push(`Coarse: numbers are means of ${coarse.map((of) => `${side(of)} pixels in the ${of.title.toLowerCase()}`).join(", of ")}.`);
  if (planes && planes.side > 1) said.push(`Backplanes: one pixel in ${side(planes)}.`);
  if (planes && cubes.some((of) => planes.side > of.side)) said.push("Pixels of finer images count as sky where they are 0 or without data.");
  if (files.length) said.push(`Drop ${files.join(" and ")} here for all pixels.`);
  if (thermal && !canSubtract()) said.push(toSubtract());
  for (const of of cubes.filter((of) => of.blob)) said.push(`Full ${of.title.toLowerCase()}: numbers are read from ${of.blob.name}.`);
  if (cube && cube.full_scale) said.push(`Values are shares of ${cube.full_scale}.`);
  by("coarse").textContent = said.join(" ");
}
