// Numbers as people read them, and what many of them are like.

/** The shortest decimal that is this number in single precision, or, if it is none, in double precision. */
function shown(value) {
  if (value === null || value === undefined || Number.isNaN(value)) return "no data";
  if (Math.fround(value) === value) {
    for (let digits = 1; digits <= 9; digits++) {
      const text = value.toPrecision(digits);
      if (Math.fround(Number(text)) === value) return String(Number(text));
    }
  }
  return String(value);
}

/** With so many digits. */
function rounded(value, digits = 5) {
  return Number.isFinite(value) ? String(Number(value.toPrecision(digits))) : shown(value);
}

/** Those that there are, ascending. */
function sorted(values, sky) {
  const kept = new Float64Array(values.length);
  let count = 0;
  for (let i = 0; i < values.length; i++) if (Number.isFinite(values[i]) && !(sky && sky[i])) kept[count++] = values[i];
  return kept.subarray(0, count).sort();
}

/** Count, mean, standard deviation (of the population), least and most. */
function moments(values) {
  let [count, sum, min, max] = [0, 0, Infinity, -Infinity];
  for (const v of values) if (Number.isFinite(v)) { count++; sum += v; min = Math.min(min, v); max = Math.max(max, v); }
  const mean = sum / count;
  let squares = 0;
  for (const v of values) if (Number.isFinite(v)) squares += (v - mean) ** 2;
  return count ? { count, mean, sd: Math.sqrt(squares / count), min, max } : { count: 0, mean: NaN, sd: NaN, min: NaN, max: NaN };
}

/** An element with text in it: never markup. */
function element(name, text, ...classes) {
  const made = document.createElement(name);
  if (text !== undefined) made.textContent = text;
  made.classList.add(...classes.filter(Boolean));
  return made;
}

function table(head, rows, kind) {
  const made = element("table", undefined, kind), top = made.createTHead().insertRow(), body = made.createTBody();
  for (const text of head) { const cell = element("th", text); cell.scope = "col"; top.append(cell); }
  for (const row of rows) { const line = body.insertRow(); for (const text of row) line.append(text instanceof Node ? text : element("td", text)); }
  return made;
}

const by = (id) => document.getElementById(id);
