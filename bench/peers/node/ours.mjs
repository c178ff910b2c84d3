// Our solver, as the module that bench/peers/node/module.cpp makes; and its ruler.
import { readFile } from 'node:fs/promises';
import { WASI } from 'node:wasi';

export class Module {
  static async load(file) {
    const wasi = new WASI({ version: 'preview1' });
    const compiled = await WebAssembly.compile(await readFile(file));
    const instance = await WebAssembly.instantiate(compiled, wasi.getImportObject());
    wasi.initialize(instance);
    return new Module(instance.exports);
  }

  constructor(exports) {
    this.exports = exports;
  }

  #write(bytes) {
    const at = this.exports.buffer(bytes.length);
    new Uint8Array(this.exports.memory.buffer, at, bytes.length).set(bytes);
    return bytes.length;
  }

  writeScene(scene) {
    return this.#write(new TextEncoder().encode(JSON.stringify(scene)));
  }

  /** Takes the scene whose bodies `measure` is told the poses of. */
  rule(scene) {
    if (this.exports.rule(this.writeScene(scene)) !== 0) throw new Error('the ruler refuses it');
  }

  /** Poses: seven numbers a body, of their frames. Millimetres. */
  measure(poses) {
    this.#write(new Uint8Array(new Float32Array(poses).buffer));
    const overlap = this.exports.overlap();
    return { lost: overlap < 0, overlap_mm: 1e3 * overlap, gap_mm: 1e3 * this.exports.gap() };
  }
}

class OurWorld {
  constructor(module, number) {
    this.module = module;
    this.number = number;
  }

  step() {
    if (this.module.exports.step(this.number) !== 0) throw new Error('our world refused a step');
  }

  poses() {
    const count = this.module.exports.poses(this.number);
    const at = this.module.exports.buffer(count * 28);
    return Array.from(new Float32Array(this.module.exports.memory.buffer, at, count * 7));
  }

  /** A pose, velocity and spin of each body: thirteen numbers. */
  motions() {
    const count = this.module.exports.motions(this.number);
    const at = this.module.exports.buffer(count * 52);
    return Array.from(new Float32Array(this.module.exports.memory.buffer, at, count * 13));
  }

  digest() {
    return BigInt.asUintN(64, this.module.exports.digest(this.number)).toString(16).padStart(16, '0');
  }

  free() {
    this.module.exports.destroy(this.number);
  }
}

export function ourEngine(module) {
  return {
    name: 'ours',
    dimensions: [2, 3],
    make(scene) {
      const number = module.exports.create(module.writeScene(scene));
      if (number < 0) throw new Error('our module refuses the scene');
      return new OurWorld(module, number);
    },
  };
}
