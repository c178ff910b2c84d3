// Runs what `cycloid_rival_charts --export FOLDER` has written, ours among the others:
//   node record.mjs MODULE.wasm FOLDER [--repeats N]
// Writes beside runs.json, for each run, its record (13 floats for each body and tick: pose of its
// frame, velocity, spin) and results.json: what a tick took in each round, ns of processor time.
// Every round runs all of them, so that what slows the machine for a while slows all alike. A run
// whose engine cannot hold the scene has `why_not`.
import { readFile, writeFile } from 'node:fs/promises';
import { argv, cpuUsage, exit, stderr } from 'node:process';
import { parseArgs } from 'node:util';
import { box2dEngine } from './box2d.mjs';
import { joltEngine } from './jolt.mjs';
import { Module, ourEngine } from './ours.mjs';
import { rapierEngine } from './rapier.mjs';
import { withoutSeats } from './scene.mjs';

/** How a run makes its world, by the name of its engine. */
async function makers(module) {
  const ours = ourEngine(module);
  const box2d = await box2dEngine();
  const planar = await rapierEngine(2);
  const spatial = await rapierEngine(3);
  const jolt = await joltEngine();
  const substeps = (run) => ({ substeps: run.substeps });
  return new Map([
    ['ours', (scene) => ours.make(scene)],
    ['Box2D v3', (scene, run) => box2d.make(scene, substeps(run))],
    ['Box2D v3, 60 Hz',
      (scene, run) => box2d.make(scene, { ...substeps(run), contact_hertz: 60 })],
    ['Rapier 2D', (scene, run) => planar.make(scene, substeps(run))],
    ['Rapier 3D', (scene, run) => spatial.make(scene, substeps(run))],
    ['Jolt', (scene, run) => jolt.make(scene, substeps(run))],
  ]);
}

/** False where the engine refuses: a world of ours that has faulted does. */
function steps(world) {
  try {
    world.step();
    return true;
  } catch {
    return false;
  }
}

/** All ticks of a run, or those before the first that is refused or has no finite number. */
function record(world, ticks) {
  const chunks = [];
  for (let tick = 0; tick < ticks && steps(world); ++tick) {
    const motions = new Float32Array(world.motions());
    if (!motions.every(Number.isFinite)) break;
    chunks.push(Buffer.from(motions.buffer));
  }
  return Buffer.concat(chunks);
}

function timeTicks(world, ticks) {
  const start = cpuUsage();
  for (let tick = 0; tick < ticks && steps(world); ++tick);
  const taken = cpuUsage(start);
  return (1000 * (taken.user + taken.system)) / ticks;
}

async function recordAll(runs, folder, make) {
  const results = [];
  for (const run of runs) {
    const scene = withoutSeats(JSON.parse(await readFile(`${folder}/${run.file}`, 'utf8')));
    const result = { times_ns: [] };
    results.push(result);
    try {
      const world = await make.get(run.engine)(scene, run);
      await writeFile(`${folder}/${run.record}`, record(world, run.ticks));
      if (world.digest !== undefined) result.digest = world.digest();
      world.free();
    } catch (error) {
      if (run.engine === 'ours') throw error;
      result.why_not = error.message;
    }
    stderr.write(`\r${results.length} of ${runs.length} recorded `);
  }
  return results;
}

async function timeAll(runs, results, folder, make) {
  for (const [i, run] of runs.entries()) {
    if (results[i].why_not !== undefined) continue;
    const scene = withoutSeats(JSON.parse(await readFile(`${folder}/${run.file}`, 'utf8')));
    const world = await make.get(run.engine)(scene, run);
    results[i].times_ns.push(timeTicks(world, run.ticks));
    world.free();
  }
}

async function main(words) {
  const { values, positionals } = parseArgs({ args: words, allowPositionals: true,
    options: { repeats: { type: 'string', default: '2' } } });
  const [wasm, folder] = positionals;
  if (positionals.length !== 2 || !(Number(values.repeats) >= 1)) {
    stderr.write('usage: node record.mjs MODULE.wasm FOLDER [--repeats N]\n');
    return 2;
  }
  const make = await makers(await Module.load(wasm));
  const runs = JSON.parse(await readFile(`${folder}/runs.json`, 'utf8'));
  const results = await recordAll(runs, folder, make);
  for (let round = 0; round < Number(values.repeats); ++round) {
    await timeAll(runs, results, folder, make);
    stderr.write(`\rround ${round + 1} of ${values.repeats} timed `);
  }
  stderr.write('\n');
  await writeFile(`${folder}/results.json`, JSON.stringify(results));
  return 0;
}

exit(await main(argv.slice(2)));
