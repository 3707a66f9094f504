// Compares `rubric decode --spec FILE` with Kaitai Struct's own parser for specs that are read at
// run time: those that ship, and plain.ksy. Frames are what `rubric generate` makes of each
// structure, and mutations of them.
// Usage: node run_time_check.js PATH_TO_RUBRIC [FRAMES_PER_STRUCTURE] [SEED]
'use strict';
const fs = require('fs');
const os = require('os');
const path = require('path');
const {spawnSync} = require('child_process');
const {faultOfError, load, fileOf} = require('./kaitai.js');
const {seeded} = require('./frames.js');

const camel = (name) => name.replace(/_(\w)/g, (_, c) => c.toUpperCase());
const pascal = (name) => name[0].toUpperCase() + camel(name).slice(1);

class Disagreement extends Error {}

function same(got, expected, where) {
  if (got !== expected) throw new Disagreement(`${where}: rubric ${got}, Kaitai ${expected}`);
}

/// Types of a spec by id, those within types, too.
function typesOf(spec) {
  const types = {};
  const add = (more) => Object.entries(more || {}).forEach(([id, type]) => {
    types[id] = type;
    add(type.types);
  });
  add(spec.types);
  if (spec.seq) types[spec.meta.id] = spec;
  return types;
}

/// Compares the fields of a record with Kaitai's object of that structure.
class Comparer {
  constructor(specs) {
    this.types = Object.assign({}, ...specs.map(typesOf));
  }

  structure(json, object, where, unsound) {
    const id = Object.keys(this.types).find((name) => pascal(name) === object.constructor.name);
    if (this.types[id]['-mask']) return same(json, this.number(object, this.types[id]), where);
    const fields = this.types[id].seq || [];
    const known = new Set(fields.flatMap(({id: key}) =>
        ['', '_name', '_bits', '_hex'].map((suffix) => key + suffix)));
    for (const key of Object.keys(json)) {
      if (!known.has(key)) throw new Disagreement(`${where}.${key}: Kaitai has no such field`);
    }
    for (const {id: key} of fields) {
      const value = object[camel(key)];
      same(key in json, value !== undefined, `${where}.${key} is there`);
      if (value !== undefined) this.value(json[key], value, `${where}.${key}`, unsound);
    }
  }

  number(mask, type) {
    return type.seq.reduce((number, bit) => 2 * number + (mask[camel(bit.id)] ? 1 : 0), 0);
  }

  value(given, value, where, unsound) {
    if (value instanceof Uint8Array) {
      // A terminator is part of the bytes that rubric shows, and no part of Kaitai's.
      const hex = Buffer.from(value).toString('hex');
      return same(given === hex + '0a' ? hex : given, hex, where);
    }
    if (Array.isArray(value)) {
      same(given.length, value.length, `${where} length`);
      return value.forEach((v, i) => this.value(given[i], v, `${where}[${i}]`, unsound));
    }
    if (typeof value === 'boolean') return same(given, value ? 1 : 0, where);
    if (typeof value === 'string') {
      return unsound ? undefined : same(given, value, where);
    }
    if (typeof value === 'number') {
      return same(typeof given === 'number' ? Math.fround(given) : given,
          Number.isFinite(value) ? Math.fround(value) : String(value), where);
    }
    return this.structure(given, value, where, unsound);
  }
}

/// {object} or {fault, offset} as Kaitai Struct sees the bytes; offset null where it has none.
function verdictOf(Type, Stream, bytes) {
  try {
    const copy = Uint8Array.from(bytes);
    return {object: new Type(new Stream(copy.buffer))};
  } catch (error) {
    const text = String(error && error.message || error);
    if (/no terminator/.test(text)) return {fault: 'truncated', offset: null};
    if (/negative|invalid.*length|Invalid typed array/i.test(text)) {
      return {fault: 'truncated', offset: null};
    }
    if (!(error.name in faultOfError)) throw error;
    const isEnd = error.name === 'EOFError';
    return {fault: faultOfError[error.name], offset: isEnd ? error.io.byteOffset + error.io.size
      : null};
  }
}

function mutated(bytes, random) {
  const out = Buffer.from(bytes);
  if (out.length === 0 || random.chance(0.1)) return Buffer.concat([out, Buffer.from([0, 255])]);
  const times = 1 + random.below(3);
  for (let i = 0; i < times; ++i) {
    const interesting = [0, 1, 2, 10, 32, 127, 128, 255, random.below(256)];
    out[random.below(out.length)] = interesting[random.below(interesting.length)];
  }
  return random.chance(0.4) ? out.subarray(0, random.below(out.length + 1)) : out;
}

function rubricLines(rubric, args, input) {
  const done = spawnSync(rubric, args, {input, encoding: 'utf8', maxBuffer: 1 << 28});
  if (done.status > 1) throw new Error(`rubric ${args.join(' ')}: ${done.stderr}`);
  return done.stdout.split('\n').filter(Boolean);
}

function disagreement({Type, Stream, comparer}, bytes, line) {
  const record = JSON.parse(line);
  if (record.raw !== bytes.toString('hex')) return 'raw differs';
  const verdict = verdictOf(Type, Stream, bytes);
  const {fault, offset} = record.error || {};
  const place = verdict.offset ?? offset;
  if (fault !== verdict.fault || offset !== place) {
    return `rubric ${fault} at ${offset}, Kaitai ${verdict.fault} at ${verdict.offset}`;
  }
  if (fault) return null;
  try {
    const unsound = record.notes.some(({note}) => note === 'not_text');
    comparer.structure(record.fields, verdict.object, record.path[0], unsound);
  } catch (error) {
    if (error instanceof Disagreement) return error.message;
    throw error;
  }
  return null;
}

/// Compares one structure; returns the number of frames, or -1 if something differs.
function compareType(rubric, file, type, kaitai, random, count) {
  // A spec without frames: each structure can come alone.
  const args = ['--spec', file, '--as', type];
  const seeds = [Buffer.alloc(0)];
  for (let i = 0; i < count / 4; ++i) {
    seeds.push(Buffer.from(Array.from({length: random.below(60)}, () => random.below(
        random.chance(0.5) ? 4 : 256))));
  }
  if (kaitai.generates) {
    const made = ['generate', '--spec', file, '--message', type, '--count', String(count),
      '--format', 'hex', '--seed', String(random.below(1e6))];
    seeds.push(...rubricLines(rubric, made, '').map((hex) => Buffer.from(
        hex.replace(/ /g, ''), 'hex')));
  }
  const frames = seeds.flatMap((bytes) => [bytes, mutated(bytes, random)]).filter((b) => b.length);
  const hex = frames.map((bytes) => bytes.toString('hex') + '\n').join('');
  const lines = rubricLines(rubric, ['decode', ...args, '--format', 'jsonl'], hex);
  let good = lines.length === frames.length;
  let accepted = 0;
  lines.forEach((line, i) => {
    const what = disagreement(kaitai, frames[i], line);
    accepted += JSON.parse(line).error === null;
    if (what && good) console.log(`${file} ${type}: ${what}\n  ${frames[i].toString('hex')}`);
    good = good && !what;
  });
  return {frames: good ? frames.length : -1, accepted};
}

async function main() {
  const [rubric, count = '60', seed = '1'] = process.argv.slice(2);
  const random = seeded(Number(seed));
  const shipped = fs.readdirSync(path.join(__dirname, '..', 'wire', 'run_time'));
  let frames = 0, accepted = 0, failed = 0;
  for (const name of [...shipped.map((file) => path.basename(file, '.ksy')).sort(), 'plain']) {
    const {parser, Stream, spec} = await load(name);
    const specs = [spec, (await load('tinyos')).spec];
    for (const id of Object.keys(typesOf(spec))) {
      if (typesOf(spec)[id]['-mask']) continue;
      const Type = id === spec.meta.id ? parser : parser[pascal(id)];
      if (!Type) continue;  // Within another type.
      const kaitai = {Type, Stream, comparer: new Comparer(specs), generates: name === 'plain'};
      const shown = typesOf(spec)[id]['-name'] || id;
      const done = compareType(rubric, fileOf(name), shown, kaitai, random, Number(count));
      failed += done.frames < 0;
      frames += Math.max(done.frames, 0);
      accepted += done.accepted;
    }
  }
  console.log(`${frames} frames, ${accepted} accepted, ${failed} structures differ`);
  process.exit(failed === 0 && accepted > frames / 5 ? 0 : 1);
}

main().catch((error) => {
  console.error(error);
  process.exit(1);
});
