// Holds our WebAssembly module to what module.cpp says of wrong arguments:
//   node refusals.mjs MODULE.wasm
// Exits with 1 and says what was otherwise. Every call has a module of its own: a trap ends one.
import { argv, exit, stderr } from 'node:process';
import { Module } from './ours.mjs';

const ball = {
  materials: [{ name: 'default' }],
  bodies: [{ shapes: [{ kind: 'ball', radius: 1 }] }],
};

/** What a call returns, or 'trap'. */
async function outcomeOf(call) {
  const module = await Module.load(argv[2]);
  try {
    return call(module.exports, module);
  } catch (error) {
    if (error instanceof WebAssembly.RuntimeError) return 'trap';
    throw error;
  }
}

const create = (exports, module, scene) => exports.create(module.writeScene(scene));

const cases = [
  ['a scene', 0, (exports, module) => create(exports, module, ball)],
  ['no scene', -1, (exports, module) => create(exports, module, [])],
  ['no JSON', 'trap', (exports) => (exports.buffer(8), exports.create(8))],
  ['more bytes than the buffer', 'trap', (exports) => (exports.buffer(8), exports.create(1 << 20))],
  ['no scene for the ruler', 1, (exports, module) => exports.rule(module.writeScene([]))],
  ['measuring without a scene', 'trap', (exports) => exports.overlap()],
  ['measuring too few poses', 'trap', (exports, module) => {
    module.rule(ball);
    exports.buffer(27);
    return exports.overlap();
  }],
];
for (const call of ['step', 'digest', 'poses', 'motions', 'destroy']) {
  for (const number of [-1, 0, 1 << 30])
    cases.push([`${call} of ${number}`, 'trap', (exports) => exports[call](number)]);
  cases.push([`${call} of a world that was destroyed`, 'trap', (exports, module) => {
    exports.destroy(create(exports, module, ball));
    return exports[call](0);
  }]);
}

let wrong = 0;
for (const [name, expected, call] of cases) {
  const outcome = await outcomeOf(call);
  if (outcome === expected) continue;
  ++wrong;
  stderr.write(`${name}: ${outcome} instead of ${expected}\n`);
}
exit(wrong === 0 ? 0 : 1);
