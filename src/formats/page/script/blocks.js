// Images whose numbers are in the page: blocks of bands, unpacked when they are asked for.

async function unpacked(id, size) {
  const text = atob(by(id).textContent), packed = new Uint8Array(text.length);
  for (let i = 0; i < text.length; i++) packed[i] = text.charCodeAt(i);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  const mixed = new Uint8Array(await new Response(stream).arrayBuffer()), bytes = new Uint8Array(mixed.length), count = mixed.length / size;
  for (let k = 0; k < size; k++) for (let i = 0; i < count; i++) bytes[i * size + k] = mixed[k * count + i];
  const data = new DataView(bytes.buffer), values = size === 4 ? new Float32Array(count) : new Float64Array(count);
  for (let i = 0; i < count; i++) values[i] = size === 4 ? data.getFloat32(4 * i, true) : data.getFloat64(8 * i, true);
  return values;
}

class Embedded {
  constructor(about) {
    Object.assign(this, about);
    this.across = Math.ceil(this.columns / this.side);
    this.down = Math.ceil(this.rows / this.side);
    this.count = this.names.length;
    this.unpacked = new Map();
  }

  block(k) {
    if (!this.unpacked.has(k)) this.unpacked.set(k, unpacked(`block${this.first_block + k}`, this.bytes[k]));
    return this.unpacked.get(k);
  }

  /** Unpacks all of it, with pauses for what is clicked meanwhile. */
  async ready() {
    for (let k = 0; k < this.bytes.length; k++) {
      await new Promise((next) => setTimeout(next));
      await this.block(k);
    }
  }

  /** All cells of a band. */
  async plane(band) {
    const k = this.starts.findLastIndex((start) => start <= band), cells = this.across * this.down;
    return (await this.block(k)).subarray((band - this.starts[k]) * cells, (band - this.starts[k] + 1) * cells);
  }

  /** Of each band mean and spread of the cells that a rectangle of pixels touches. */
  async region([x0, y0, x1, y1]) {
    const [left, top, right, bottom] = [x0, y0, x1, y1].map((v) => Math.floor(v / this.side)), all = [];
    for (let band = 0; band < this.count; band++) {
      const plane = await this.plane(band), values = [];
      for (let y = top; y <= bottom; y++) for (let x = left; x <= right; x++) values.push(plane[y * this.across + x]);
      all.push(moments(values));
    }
    return all;
  }

  /** What a number stands for. */
  get told() {
    if (this.side === 1) return "";
    return this.cells === "mean" ? `mean of ${this.side} × ${this.side} pixels` : `of one pixel in ${this.side} × ${this.side}`;
  }
}
