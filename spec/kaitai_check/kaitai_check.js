// Compares `rubric decode` with Kaitai Struct's own parser: same frames accepted, same faults in
// the same places, same fields, same bytes left over.
// Usage: node kaitai_check.js PATH_TO_RUBRIC [COUNT] [SEED]. Without COUNT it compares as many
// frames as README.md says, as many different mutated ones among them.
'use strict';
const assert = require('node:assert');
const fs = require('fs');
const os = require('os');
const path = require('path');
const readline = require('readline');
const {spawn} = require('child_process');
const {faultOfError, load} = require('./kaitai.js');
const {makeFrames} = require('./frames.js');
const {Comparer, Disagreement} = require('./compare.js');
const {readmeNumber} = require('../../tools/tests/readme/number.js');

const captures = path.join(__dirname, '..', 'captures');
// The runs, and their share of COUNT.
const suites = [
  {carrier: 'serial', spec: 'rubicon', share: 0.7, real: true},
  {carrier: 'radio_i', spec: 'rubicon', share: 0.15, as: 'RadioIFrame'},
  {carrier: 'radio_t', spec: 'rubicon', share: 0.1, as: 'RadioTFrame'},
  {carrier: 'serial', spec: 'oscilloscope', share: 0.05},
];

const nameOf = ({spec, carrier}) => `${spec} ${carrier}`;

/// Bytes of the number that a path such as /types/net_msg/seq/3 names.
function widthAt(specs, srcPath) {
  for (const spec of specs) {
    const field = srcPath.split('/').slice(1).reduce((at, key) => at && at[key], spec);
    if (field) return Number(/^[us](\d)/.exec(field.type)[1]);
  }
  throw new Error(`no ${srcPath} in the spec`);
}

/// Returns the place of Kaitai's error: the end for missing bytes, the beginning for a value.
function offsetOf(error, specs) {
  const {io, srcPath} = error;
  return io.byteOffset + (srcPath ? io.pos - widthAt(specs, srcPath) : io.size);
}

/// {object} or {fault, offset} as Kaitai Struct sees the frame.
function kaitaiVerdict({Parser, Stream, specs}, frame) {
  // A copy that begins at 0 of its buffer, so that offsets in the buffer are those in the frame.
  const buffer = frame.buffer.slice(frame.byteOffset, frame.byteOffset + frame.length);
  const stream = new Stream(buffer);
  try {
    const object = new Parser(stream);
    return stream.isEof() ? {object} : {fault: 'trailing', offset: stream.pos};
  } catch (error) {
    if (!(error.name in faultOfError)) throw error;
    return {fault: faultOfError[error.name], offset: offsetOf(error, specs)};
  }
}

function disagreement(kaitai, frame, record) {
  const verdict = kaitaiVerdict(kaitai, frame);
  const {fault, offset} = record.error || {};
  if (record.raw !== frame.toString('hex')) return 'raw differs';
  if (fault !== verdict.fault || offset !== verdict.offset) {
    const said = (v) => v.fault ? `${v.fault} at ${v.offset}` : 'accepts';
    return `rubric ${said({fault, offset})}, Kaitai ${said(verdict)}`;
  }
  if (fault) return null;
  // The record shows the message of a serial frame; with --as all of it.
  const message = kaitai.whole ? verdict.object : verdict.object.payload;
  if (message instanceof Uint8Array || message === undefined) {
    // A radio message in a serial packet is shown with a note; the serial carrier has no such case.
    const radioOnly = record.notes.some(({note}) => note === 'radio_only');
    if (record.message === null || radioOnly) return null;
    return `rubric ${record.message}, Kaitai opaque`;
  }
  try {
    kaitai.comparer.message(record, message);
  } catch (error) {
    if (error instanceof Disagreement) return error.message;
    throw error;
  }
  return null;
}

async function loadSuite({spec, as}) {
  const {parser, Stream, spec: main} = await load(spec);
  const specs = [main, (await load('tinyos')).spec];
  return {Parser: as ? parser[as] : parser, Stream, specs, whole: Boolean(as),
    comparer: new Comparer(specs)};
}

const count = (counts, key) => counts[key] = (counts[key] || 0) + 1;

/// Counts the frames of each origin; adds those that `mutated` does not have yet to it.
function census(frames, mutated) {
  const origins = {};
  for (const {origin, bytes} of frames) {
    count(origins, origin);
    if (origin === 'mutated') mutated.add(bytes.toString('latin1'));
  }
  return origins;
}

/// Decodes the frames by both; {index: frames decoded, status, disagreements, faults, messages}.
async function hold(rubric, suite, frames) {
  const kaitai = await loadSuite(suite);
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'rubric-kaitai-'));
  const file = path.join(folder, 'frames.hex');
  fs.writeFileSync(file, frames.map((f) => f.bytes.toString('hex') + '\n').join(''));
  const args = ['decode', '--input-format', 'hex', '--format', 'jsonl', '--spec', suite.spec,
    ...(suite.as ? ['--as', `${suite.carrier}_frame`] : []), file];
  const child = spawn(rubric, args, {stdio: ['ignore', 'pipe', 'inherit']});
  const ended = new Promise((resolve) => child.on('close', resolve));
  const result = {index: 0, disagreements: 0, faults: {}, messages: {}};
  for await (const line of readline.createInterface({input: child.stdout})) {
    const record = JSON.parse(line);
    const {bytes} = frames[result.index++];
    const what = disagreement(kaitai, bytes, record);
    if (what && ++result.disagreements <= 10) {
      console.log(`${nameOf(suite)} frame ${result.index}: ${what}\n  ${bytes.toString('hex')}`);
    }
    count(result.faults, record.error ? record.error.fault : 'accepted');
    if (!record.error) count(result.messages, record.message);
  }
  result.status = await ended;
  fs.rmSync(folder, {recursive: true});
  return result;
}

/// Runs one suite and says what came of it; whether it is good.
async function run(rubric, suite, total, seed, mutated) {
  const frames = makeFrames(rubric, suite, captures, Math.round(total * suite.share), seed);
  const origins = census(frames, mutated);
  const result = await hold(rubric, suite, frames);
  const rejected = result.index - (result.faults.accepted || 0);
  const share = (100 * rejected / result.index).toFixed(1);
  console.log(`${nameOf(suite)}: ${result.index} frames, ${JSON.stringify(origins)}, ` +
      `rejected ${rejected} (${share} %); seed ${seed}`);
  console.log('  by fault:', JSON.stringify(result.faults));
  console.log('  by message:', JSON.stringify(result.messages));
  console.log(`  disagreements: ${result.disagreements}`);
  return result.status <= 1 && result.index === frames.length &&
      result.disagreements === 0 && rejected >= 0.1 * result.index;
}

async function main() {
  const [rubric, count, seed = '1'] = process.argv.slice(2);
  const total = Number(count ?? readmeNumber('# frames of serial lines'));
  const mutated = new Set();
  let passed = 0;
  for (const suite of suites) passed += await run(rubric, suite, total, Number(seed), mutated);
  console.log(`${mutated.size} different mutated frames; ` +
      `${passed} passed, ${suites.length - passed} failed`);
  if (!count) assert.equal(mutated.size, readmeNumber('# of them different mutated ones'));
  process.exit(passed === suites.length ? 0 : 1);
}

main().catch((error) => {
  console.error(error);
  process.exit(1);
});
