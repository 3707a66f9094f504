// Compares `rubric decode --spec FILE` with Kaitai Struct's own parser for specs that are read at
// run time: those that ship, and the four here. Frames are what `rubric generate` makes of each
// structure, and mutations of them.
// Usage: node run_time_check.js PATH_TO_RUBRIC [FRAMES_PER_STRUCTURE] [SEED]
'use strict';
const fs = require('fs');
const path = require('path');
const {faultOfError, load, fileOf} = require('./kaitai.js');
const {mutate, records, seeded} = require('./frames.js');
const {Comparer, Disagreement, pascal, typesOf} = require('./compare.js');

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

function disagreement({Type, Stream, comparer}, bytes, record) {
  if (record.raw !== bytes.toString('hex')) return 'raw differs';
  const verdict = verdictOf(Type, Stream, bytes);
  const {fault, offset} = record.error || {};
  const place = verdict.offset ?? offset;
  if (fault !== verdict.fault || offset !== place) {
    return `rubric ${fault} at ${offset}, Kaitai ${verdict.fault} at ${verdict.offset}`;
  }
  if (fault) return null;
  try {
    comparer.message(record, verdict.object);
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
      '--seed', String(random.below(1e6))];
    seeds.push(...records(rubric, made).map(({raw}) => Buffer.from(raw, 'hex')));
  }
  const frames = seeds.flatMap((bytes) => [bytes, mutate(bytes, random)]).filter((b) => b.length);
  const hex = frames.map((bytes) => bytes.toString('hex') + '\n').join('');
  const decoded = records(rubric, ['decode', ...args, '--format', 'jsonl'], hex);
  let good = decoded.length === frames.length;
  let accepted = 0;
  decoded.forEach((record, i) => {
    const what = disagreement(kaitai, frames[i], record);
    accepted += record.error === null;
    if (what && good) console.log(`${file} ${type}: ${what}\n  ${frames[i].toString('hex')}`);
    good = good && !what;
  });
  return {frames: good ? frames.length : -1, accepted};
}

async function main() {
  const [rubric, count = '60', seed = '1'] = process.argv.slice(2);
  const random = seeded(Number(seed));
  const shipped = fs.readdirSync(path.join(__dirname, '..', 'wire', 'run_time'));
  const plain = ['plain', 'lists', 'computed', 'wide'];
  let frames = 0, accepted = 0, failed = 0;
  for (const name of [...shipped.map((file) => path.basename(file, '.ksy')).sort(), ...plain]) {
    const {parser, Stream, spec} = await load(name);
    const specs = [spec, (await load('tinyos')).spec];
    for (const id of Object.keys(typesOf(spec))) {
      // A type with parameters comes within another one.
      if (typesOf(spec)[id]['-mask'] || typesOf(spec)[id].params) continue;
      const Type = id === spec.meta.id ? parser : parser[pascal(id)];
      if (!Type) continue;  // Within another type.
      const kaitai = {Type, Stream, comparer: new Comparer(specs), generates: plain.includes(name)};
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
