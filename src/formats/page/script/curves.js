// Curves over wavelength, as a drawing.

const SVG = "http://www.w3.org/2000/svg";

function shape(name, of, text) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(of)) made.setAttribute(key, value);
  if (text !== undefined) made.textContent = text;
  return made;
}

/** Round numbers within a range. */
function ticks(low, high, wanted) {
  const rough = (high - low) / wanted, power = 10 ** Math.floor(Math.log10(rough)), step = power * [1, 2, 5, 10].find((n) => n * power >= rough);
  const found = [];
  for (let at = Math.ceil(low / step) * step; at <= high + step * 1e-9 && found.length < 30; at += step) found.push(Number(at.toPrecision(12)));
  return found;
}

/** Curves: { name, x, y, spread, colour, dash }. */
function plot(holder, curves, [across, along], cursor) {
  const [width, height, left, right, top, bottom] = [520, 300, 58, 8, 10, 36];
  const xs = curves.flatMap((c) => Array.from(c.x)).filter(Number.isFinite), ys = [];
  for (const c of curves) for (let i = 0; i < c.y.length; i++) if (Number.isFinite(c.y[i])) ys.push(c.y[i] - (c.spread ? c.spread[i] : 0), c.y[i] + (c.spread ? c.spread[i] : 0));
  holder.replaceChildren();
  if (!xs.length || !ys.length) { holder.append(element("p", "No data to draw.")); return; }
  const ends = (values, pad) => {
    const low = values.reduce((a, b) => Math.min(a, b)), high = values.reduce((a, b) => Math.max(a, b)), more = (high - low || Math.abs(high)) * pad || pad;
    return [low - more, high + more];
  };
  const [x0, x1] = ends(xs, xs.every((x) => x === xs[0]) ? 0.5 : 0), [y0, y1] = ends(ys, 0.06);
  const X = (x) => left + (x - x0) / (x1 - x0) * (width - left - right), Y = (y) => height - bottom - (y - y0) / (y1 - y0) * (height - top - bottom);
  const svg = shape("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": `${along} over ${across}: ${curves.map((c) => c.name).join(", ")}` });
  for (const x of ticks(x0, x1, 6)) svg.append(shape("line", { x1: X(x), x2: X(x), y1: top, y2: height - bottom, stroke: "var(--line)" }), shape("text", { x: X(x), y: height - bottom + 14, "text-anchor": "middle" }, rounded(x, 4)));
  for (const y of ticks(y0, y1, 5)) svg.append(shape("line", { x1: left, x2: width - right, y1: Y(y), y2: Y(y), stroke: "var(--line)" }), shape("text", { x: left - 5, y: Y(y) + 4, "text-anchor": "end" }, rounded(y, 3)));
  svg.append(shape("text", { x: (left + width) / 2, y: height - 5, "text-anchor": "middle" }, across), shape("text", { x: 12, y: height / 2, transform: `rotate(-90 12 ${height / 2 - 10})`, "text-anchor": "middle" }, along));
  if (Number.isFinite(cursor)) svg.append(shape("line", { x1: X(cursor), x2: X(cursor), y1: top, y2: height - bottom, stroke: "var(--soft)", "stroke-dasharray": "2 3" }));
  for (const c of curves) {
    const points = Array.from(c.x, (x, i) => [x, c.y[i], c.spread ? c.spread[i] : 0]).filter(([x, y]) => Number.isFinite(x) && Number.isFinite(y)).sort((a, b) => a[0] - b[0]);
    const line = (of) => of.map(([x, y]) => `${X(x).toFixed(2)} ${Y(y).toFixed(2)}`).join("L");
    if (points.length === 1) { svg.append(shape("circle", { cx: X(points[0][0]), cy: Y(points[0][1]), r: 3, fill: c.colour })); continue; }
    if (c.spread && points.length) svg.append(shape("path", { d: `M${line(points.map(([x, y, s]) => [x, y + s]))}L${line(points.map(([x, y, s]) => [x, y - s]).reverse())}Z`, fill: c.colour, opacity: 0.15 }));
    if (points.length) svg.append(shape("path", { d: `M${line(points)}`, fill: "none", stroke: c.colour, "stroke-width": 1.5, "stroke-dasharray": c.dash || "none" }));
  }
  holder.append(svg);
}
