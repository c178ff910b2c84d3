// Runs a WebAssembly program of wasi under Node:  node wasi.mjs PROGRAM.wasm [ARGUMENT...]
// The program sees the folder in WASI_FOLDER (default: the current one) as its current folder, and
// what lies in it, for reading and writing. The exit code is the program's; 70 where it trapped.
import { readFile } from 'node:fs/promises';
import { argv, env, exit, stderr } from 'node:process';
import { WASI } from 'node:wasi';

const kExitTrapped = 70;
const kExitUsage = 2;

async function main([program, ...words]) {
  if (program === undefined) {
    stderr.write('usage: node wasi.mjs PROGRAM.wasm [ARGUMENT...]\n');
    return kExitUsage;
  }
  const wasi = new WASI({
    version: 'preview1',
    args: ['cycloid', ...words],
    env: {},
    preopens: { '.': env.WASI_FOLDER ?? '.' },
    returnOnExit: true,
  });
  const module = await WebAssembly.compile(await readFile(program));
  const instance = await WebAssembly.instantiate(module, wasi.getImportObject());
  try {
    return wasi.start(instance);
  } catch (error) {
    stderr.write(`wasi: ${program}: ${error}\n`);
    return kExitTrapped;
  }
}

exit(await main(argv.slice(2)));
