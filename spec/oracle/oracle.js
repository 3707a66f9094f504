// Holds `rubric decode` against Kaitai Struct's own parser: same frames accepted, same faults, same
// fields. Usage: node oracle.js PATH_TO_RUBRIC [COUNT] [SEED]
'use strict';
const fs = require('fs');
const os = require('os');
const path = require('path');
const readline = require('readline');
const {spawn} = require('child_process');
const {load} = require('./kaitai.js');
const {makeFrames} = require('./frames.js');
const {Comparer, Disagreement} = require('./compare.js');

const faultOfError = {
  EOFError: 'truncated',
  ValidationNotEqualError: 'unexpected',
  ValidationNotAnyOfError: 'unexpected',
  ValidationNotInEnumError: 'unexpected',
  ValidationLessThanError: 'out_of_range',
  ValidationGreaterThanError: 'out_of_range',
};

/// {object} or {fault} as Kaitai Struct sees the frame.
function kaitaiVerdict(kaitai, frame) {
  const buffer = frame.buffer.slice(frame.byteOffset, frame.byteOffset + frame.length);
  const stream = new kaitai.Stream(buffer);
  try {
    const object = new kaitai.parser(stream);
    return stream.isEof() ? {object} : {fault: 'trailing'};
  } catch (error) {
    const name = error.name === 'Error' ? error.constructor.name : error.name;
    if (!(name in faultOfError)) throw error;
    return {fault: faultOfError[name]};
  }
}

function disagreement(kaitai, comparer, frame, record) {
  const verdict = kaitaiVerdict(kaitai, frame);
  const fault = record.error ? record.error.fault : undefined;
  if (record.raw !== frame.toString('hex')) return 'raw differs';
  if (fault !== verdict.fault) {
    return `rubric ${fault || 'accepts'}, Kaitai ${verdict.fault || 'accepts'}`;
  }
  if (fault) return null;
  const message = verdict.object.payload;
  if (message instanceof Uint8Array || message === undefined) {
    return record.message === null ? null : `rubric ${record.message}, Kaitai opaque`;
  }
  try {
    comparer.structure(record.fields, message, record.path[0]);
  } catch (error) {
    if (error instanceof Disagreement) return error.message;
    throw error;
  }
  return null;
}

async function main() {
  const [rubric, count = '100000', seed = '1'] = process.argv.slice(2);
  const kaitai = await load('rubicon');
  const tinyos = await load('tinyos');
  const comparer = new Comparer([kaitai.spec, tinyos.spec]);
  const frames = makeFrames(path.join(__dirname, '..', 'captures'), Number(count), Number(seed));
  const file = path.join(fs.mkdtempSync(path.join(os.tmpdir(), 'rubric-oracle-')), 'frames.hex');
  fs.writeFileSync(file, frames.map((f) => f.toString('hex') + '\n').join(''));

  const args = ['decode', '--input-format', 'hex', '--format', 'jsonl', file];
  const child = spawn(rubric, args, {stdio: ['ignore', 'pipe', 'inherit']});
  const ended = new Promise((resolve) => child.on('close', resolve));
  const faults = {};
  const messages = {};
  let index = 0;
  let disagreements = 0;
  for await (const line of readline.createInterface({input: child.stdout})) {
    const record = JSON.parse(line);
    const frame = frames[index++];
    const what = disagreement(kaitai, comparer, frame, record);
    if (what && ++disagreements <= 10) {
      console.log(`frame ${index}: ${what}\n  ${frame.toString('hex')}`);
    }
    const fault = record.error ? record.error.fault : 'accepted';
    faults[fault] = (faults[fault] || 0) + 1;
    if (!record.error) messages[record.message] = (messages[record.message] || 0) + 1;
  }
  const status = await ended;
  fs.rmSync(path.dirname(file), {recursive: true});

  const rejected = index - (faults.accepted || 0);
  const share = (100 * rejected / index).toFixed(1);
  console.log(`frames: ${index}, rejected: ${rejected} (${share} %), seed ${seed}`);
  console.log('by fault:', JSON.stringify(faults));
  console.log('by message:', JSON.stringify(messages));
  console.log(`disagreements: ${disagreements}`);
  const good = status <= 1 && index === frames.length && disagreements === 0 &&
      rejected >= 0.3 * index;
  console.log(good ? '1 passed, 0 failed' : '0 passed, 1 failed');
  process.exit(good ? 0 : 1);
}

main().catch((error) => {
  console.error(error);
  process.exit(1);
});
