// A decoder for compare.py: the parser that Kaitai Struct's own compiler makes from .ksy files.
// Usage: node kaitai_decoder.js FOLDER_OF_KSY FOLDER_WITH_NODE_MODULES
'use strict';
const fs = require('fs');
const os = require('os');
const path = require('path');
const readline = require('readline');
const {createRequire} = require('module');

const [specFolder, npmFolder] = process.argv.slice(2).map((folder) => path.resolve(folder));
const npm = createRequire(path.join(npmFolder, 'package.json'));
const yaml = npm('js-yaml');
const compiler = npm('kaitai-struct-compiler');

const readSpec = (name) =>
  yaml.load(fs.readFileSync(path.join(specFolder, `${name}.ksy`), 'utf8'));
const snake = (name) => name.replace(/([A-Z])/g, (c) => '_' + c.toLowerCase()).replace(/^_/, '');

/// Loads the module of the parser for that spec.
async function load(name) {
  const files = await compiler.compile('javascript', readSpec(name),
      {importYaml: async (imported) => readSpec(imported)}, false);
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'kaitai-decoder-'));
  fs.symlinkSync(path.join(npmFolder, 'node_modules'), path.join(folder, 'node_modules'));
  for (const [file, text] of Object.entries(files)) {
    fs.writeFileSync(path.join(folder, file), text);
  }
  const className = name[0].toUpperCase() + name.slice(1);
  const parser = require(path.join(folder, `${className}.js`))[className];
  fs.rmSync(folder, {recursive: true});
  return parser;
}

/// Returns the shown names of types, by their names in the spec.
function shownNames(specs) {
  const names = {};
  for (const spec of specs) {
    for (const [id, type] of Object.entries(spec.types || {})) names[id] = type['-name'] || id;
  }
  return names;
}

/// Collects the numbers of an object and of the structures in it, by "structure.field".
function numbers(object, shown, out) {
  const type = snake(object.constructor.name);
  for (const [key, value] of Object.entries(object)) {
    if (key.startsWith('_')) continue;
    if (typeof value === 'number') {
      const name = `${shown[type] || type}.${snake(key)}`;
      (out[name] = out[name] || []).push(value);
    } else if (value && value.constructor && value._io) {
      numbers(value, shown, out);
    }
  }
  return out;
}

function answer(parsers, Stream, shown, line) {
  const [carrier, hex] = line.split(' ');
  const Parser = parsers[carrier];
  if (!Parser) return {skip: true};
  const frame = Buffer.from(hex, 'hex');
  const stream = new Stream(
      frame.buffer.slice(frame.byteOffset, frame.byteOffset + frame.length));
  try {
    const object = new Parser(stream);
    if (!stream.isEof()) return {accept: false, why: 'bytes after the end'};
    return {accept: true, fields: numbers(object, shown, {})};
  } catch (error) {
    // Any other error is a crash, not a verdict.
    if (!/^(EOF|Validation\w*)Error$/.test(error.name)) return {crash: String(error)};
    return {accept: false, why: `${error.name}: ${error.message}`};
  }
}

async function main() {
  const [rubicon, tinyos] = [await load('rubicon'), await load('tinyos')];
  const Stream = npm('kaitai-struct/KaitaiStream');
  const shown = shownNames([readSpec('rubicon'), readSpec('tinyos')]);
  const parsers = {serial: rubicon, radio_i: rubicon.RadioIFrame, radio_t: rubicon.RadioTFrame,
    radio_ack: tinyos.MacAck};
  for await (const line of readline.createInterface({input: process.stdin})) {
    process.stdout.write(JSON.stringify(answer(parsers, Stream, shown, line)) + '\n');
  }
}

main().catch((error) => {
  console.error(error);
  process.exit(1);
});
