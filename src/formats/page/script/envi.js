// A whole cube in a file of the user's, of which only what is shown is read.

const TYPES = {
  1: [1, "getUint8"], 2: [2, "getInt16"], 3: [4, "getInt32"], 4: [4, "getFloat32"], 5: [8, "getFloat64"],
  12: [2, "getUint16"], 13: [4, "getUint32"], 14: [8, "getBigInt64"], 15: [8, "getBigUint64"],
};
/** So much is read at once, bytes. */
const PIECE = 8 << 20;

/** What a header says; a key without a value says nothing. */
function header(text) {
  const keys = {};
  for (const [, key, value] of text.replace(/\r\n?/g, "\n").matchAll(/^\s*([^=\n{}]+?)[^\S\n]*=[^\S\n]*(\{[^}]*\}|[^\n]*)/gm)) if (value.trim()) keys[key.toLowerCase()] = value.trim();
  const number = (key, otherwise) => (key in keys ? Number(keys[key]) : otherwise), ignore = number("data ignore value", NaN);
  return {
    columns: number("samples"), rows: number("lines"), count: number("bands"), interleave: (keys.interleave || "bsq").toLowerCase(),
    data_type: number("data type"), big_endian: number("byte order", 0) === 1, offset: number("header offset", 0), ignore: Number.isFinite(ignore) ? ignore : null,
    scaled: "data gain values" in keys || "data offset values" in keys || "reflectance scale factor" in keys,
  };
}

class FullCube {
  constructor(blob, embedded, layout) {
    const { key, title, unit, columns, rows, count, names, um, fwhm_um, colours } = embedded;
    Object.assign(this, { key, title, unit, columns, rows, count, names, um, fwhm_um, colours, blob, side: 1, across: columns, down: rows, told: "" }, layout);
    const type = TYPES[this.data_type], { name } = blob;
    if (!type) throw new Error(`${name}: numbers of type ${this.data_type} are not read`);
    [this.size, this.get] = type;
    // It was written in decimals, and the numbers may be f32.
    if (this.data_type === 4 && this.ignore !== null) this.ignore = Math.fround(this.ignore);
    const wanted = this.offset + columns * rows * count * this.size;
    if (layout.scaled) throw new Error(`${name}: its header scales the numbers: make a page of it with mmxrt view`);
    if (this.columns !== columns || this.rows !== rows || this.count !== count) throw new Error(`${name}: its header says ${this.columns} × ${this.rows} × ${this.count}, this page is of ${columns} × ${rows} × ${count}`);
    if (blob.size < wanted) throw new Error(`${name} has ${blob.size} bytes; ${columns} × ${rows} pixels of ${count} bands take ${wanted}`);
  }

  /** Numbers from the one at `from`. */
  async numbers(from, count) {
    const start = this.offset + from * this.size, data = new DataView(await this.blob.slice(start, start + count * this.size).arrayBuffer());
    const values = new Float64Array(count);
    for (let i = 0; i < count; i++) {
      const value = Number(data[this.get](i * this.size, !this.big_endian));
      values[i] = value === this.ignore ? NaN : value;
    }
    return values;
  }

  async plane(band) {
    const { columns, rows, count } = this;
    if (this.interleave === "bsq") return this.numbers(band * columns * rows, columns * rows);
    const plane = new Float64Array(columns * rows);
    if (this.interleave === "bil") {
      for (let y = 0; y < rows; y++) plane.set(await this.numbers((y * count + band) * columns, columns), y * columns);
      return plane;
    }
    const together = Math.max(1, Math.floor(PIECE / (columns * count * this.size)));
    for (let y = 0; y < rows; y += together) {
      const pixels = columns * Math.min(together, rows - y), values = await this.numbers(y * columns * count, pixels * count);
      for (let i = 0; i < pixels; i++) plane[y * columns + i] = values[i * count + band];
    }
    return plane;
  }

  async region([x0, y0, x1, y1]) {
    const { columns, rows, count } = this, width = x1 - x0 + 1, all = [];
    if (this.interleave === "bsq") {
      for (let band = 0; band < count; band++) {
        const part = await this.numbers((band * rows + y0) * columns + x0, (y1 - y0) * columns + width), values = new Float64Array(width * (y1 - y0 + 1));
        for (let y = 0; y <= y1 - y0; y++) values.set(part.subarray(y * columns, y * columns + width), y * width);
        all.push(moments(values));
      }
      return all;
    }
    const of = Array.from({ length: count }, () => []), isBil = this.interleave === "bil";
    for (let y = y0; y <= y1; y++) {
      const line = isBil ? await this.numbers(y * columns * count, columns * count) : await this.numbers((y * columns + x0) * count, width * count);
      for (let x = 0; x < width; x++) for (let band = 0; band < count; band++) of[band].push(isBil ? line[band * columns + x0 + x] : line[x * count + band]);
    }
    return of.map(moments);
  }
}
