// Our WebAssembly module beside the packages of others, on the scenes of a folder:
//   node main.mjs MODULE.wasm FOLDER CSV [--runs N] [--worlds N] [--markdown FILE]
// Chunk by chunk in turn in one process, as bench/runner/measure.cpp does it; controls left out.
// Prints a line for each engine and writes CSV, and the table between "<!-- begin node -->" and
// "<!-- end node -->" of the markdown file. Exits with 1 where our module refuses a scene.
import { readFile, readdir, writeFile } from 'node:fs/promises';
import { cpus } from 'node:os';
import { argv, cpuUsage, exit, stderr, stdout, version } from 'node:process';
import { parseArgs } from 'node:util';
import { box2dEngine } from './box2d.mjs';
import { joltEngine } from './jolt.mjs';
import { Module, ourEngine } from './ours.mjs';
import { rapierEngine } from './rapier.mjs';
import { withoutSeats } from './scene.mjs';

const kWarmTicks = 180;
const kChunks = 12;
const kChunkTicks = 5;

function median(values) {
  return [...values].sort((a, b) => a - b)[values.length >> 1];
}

/** Microseconds of processor time. */
function stepAll(worlds, ticks) {
  const start = cpuUsage();
  for (let tick = 0; tick < ticks; ++tick) for (const world of worlds) world.step();
  const taken = cpuUsage(start);
  return taken.user + taken.system;
}

async function makeWorlds(contender, scene, count) {
  const worlds = [];
  try {
    while (worlds.length < count) worlds.push(await contender.engine.make(scene));
    return worlds;
  } catch (error) {
    if (contender.engine.name === 'ours') throw error;
    contender.whyNot = error.message;
    return [];
  }
}

async function runOnce(scene, contenders, options) {
  for (const contender of contenders) {
    contender.worlds = await makeWorlds(contender, scene, options.worlds);
    stepAll(contender.worlds, kWarmTicks);
  }
  for (let chunk = 0; chunk < kChunks; ++chunk)
    for (const contender of contenders)
      if (contender.worlds.length > 0)
        contender.chunks[chunk].push(stepAll(contender.worlds, kChunkTicks));
  for (const contender of contenders) {
    if (contender.worlds.length === 0) continue;
    contender.accuracy = options.ruler.measure(contender.worlds[0].poses());
    contender.digest = contender.worlds[0].digest?.() ?? '';
    for (const world of contender.worlds) world.free();
  }
}

function rowOf(scene, contender, ours, worlds) {
  const { engine, chunks, accuracy, digest, whyNot } = contender;
  if (whyNot !== undefined) return { scene: scene.name, engine: engine.name, whyNot };
  const sum = chunks.reduce((total, runs) => total + median(runs), 0);
  const ratios = chunks.flatMap((runs, chunk) =>
    runs.map((taken, run) => ours.chunks[chunk][run] / taken));
  return { scene: scene.name, engine: engine.name,
    step_us: sum / (kChunks * kChunkTicks * worlds), ratio: median(ratios), ...accuracy,
    digest };
}

function print(row) {
  if (row.whyNot !== undefined) {
    stdout.write(`${row.scene.padEnd(18)} ${row.engine.padEnd(12)} not measured: ${row.whyNot}\n`);
    return;
  }
  const accuracy = row.lost ? 'lost'
    : `${row.overlap_mm.toFixed(1)} / ${row.gap_mm.toFixed(1)} mm`;
  stdout.write(`${row.scene.padEnd(18)} ${row.engine.padEnd(12)} ` +
    `${row.step_us.toFixed(2).padStart(10)} us ${row.ratio.toFixed(2).padStart(6)}  ` +
    `${accuracy.padStart(18)}  ${row.digest}\n`);
}

async function measure(scene, engines, options) {
  const dimension = scene.dimension ?? 2;
  const contenders = engines
    .filter((engine) => engine.dimensions.includes(dimension))
    .map((engine) => ({ engine, chunks: Array.from({ length: kChunks }, () => []) }));
  options.ruler.rule(scene);
  for (let run = 0; run < options.runs; ++run) await runOnce(scene, contenders, options);
  const rows = contenders.map(
    (contender) => rowOf(scene, contender, contenders[0], options.worlds));
  rows.forEach(print);
  return rows;
}

function csvOf(rows) {
  const names = ['scene', 'engine', 'step_us', 'ratio', 'overlap_mm', 'gap_mm', 'lost', 'digest',
    'whyNot'];
  const lines = rows.map((row) => names.map((name) => JSON.stringify(row[name] ?? '')).join(','));
  return [names.join(','), ...lines, ''].join('\n');
}

function markdownOf(rows, options) {
  const head = `| scene | engine | µs | ours / it | overlap / gap mm | digest |\n${'|---'.repeat(6)}|\n`;
  const lines = rows.map((row) => row.whyNot !== undefined
    ? `| ${row.scene} | ${row.engine} | not measured: ${row.whyNot} | | | |\n`
    : `| ${row.scene} | ${row.engine} | ${row.step_us.toPrecision(3)} | ${row.ratio.toFixed(2)} | ` +
      `${row.lost ? 'lost' : `${row.overlap_mm.toFixed(1)} / ${row.gap_mm.toFixed(1)}`} | ` +
      `${row.digest} |\n`);
  const day = new Date().toISOString().slice(0, 10);
  return `${cpus()[0].model}, ${cpus().length} processors, Node ${version}, ${day}. ` +
    `${options.runs} runs of ${options.worlds} worlds.\n\n${head}${lines.join('')}`;
}

async function replaceSection(file, text) {
  const before = await readFile(file, 'utf8');
  const after = before.replace(/(<!-- begin node -->\n)[^]*?(<!-- end node -->\n)/,
    (_, begin, end) => begin + text + end);
  if (after === before && !before.includes('<!-- begin node -->\n'))
    throw new Error(`${file}: has no section node`);
  await writeFile(file, after);
}

/** What the command line says, or null where it says something else. */
function optionsOf(words) {
  try {
    const { values, positionals } = parseArgs({ args: words, allowPositionals: true, options: {
      runs: { type: 'string', default: '3' },
      worlds: { type: 'string', default: '20' },
      markdown: { type: 'string' },
    } });
    const [wasm, folder, csv] = positionals;
    const options = { wasm, folder, csv, markdown: values.markdown, runs: Number(values.runs),
      worlds: Number(values.worlds) };
    const good = positionals.length === 3 && options.runs >= 1 && options.worlds >= 1;
    return good ? options : null;
  } catch {
    return null;
  }
}

async function main(words) {
  const options = optionsOf(words);
  if (options === null) {
    stderr.write('usage: node main.mjs MODULE.wasm FOLDER CSV [--runs N] [--worlds N] ' +
      '[--markdown FILE]\n');
    return 2;
  }
  options.ruler = await Module.load(options.wasm);
  const engines = [ourEngine(options.ruler), await box2dEngine(), await rapierEngine(2),
    await rapierEngine(3), await joltEngine()];
  const files = (await readdir(options.folder)).filter((file) => file.endsWith('.json')).sort();
  const rows = [];
  for (const file of files) {
    const text = await readFile(`${options.folder}/${file}`, 'utf8');
    rows.push(...await measure(withoutSeats(JSON.parse(text)), engines, options));
  }
  await writeFile(options.csv, csvOf(rows));
  if (options.markdown !== undefined)
    await replaceSection(options.markdown, markdownOf(rows, options));
  return 0;
}

exit(await main(argv.slice(2)));
