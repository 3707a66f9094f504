// Makes frames to compare both decoders on: real ones, and those that `rubric generate` makes of
// every message, sound and broken; most are mutated. Seeded, so a run can be repeated.
'use strict';
const fs = require('fs');
const path = require('path');
const {spawnSync} = require('child_process');

/// A small seeded generator (mulberry32); below(n) gives 0..n-1.
function seeded(seed) {
  let state = seed >>> 0;
  const next = () => {
    state = (state + 0x6d2b79f5) >>> 0;
    let t = state;
    t = Math.imul(t ^ (t >>> 15), t | 1);
    t ^= t + Math.imul(t ^ (t >>> 7), t | 61);
    return ((t ^ (t >>> 14)) >>> 0) / 4294967296;
  };
  return {below: (n) => Math.floor(next() * n), chance: (p) => next() < p};
}

function realFrames(folder) {
  const frames = [];
  for (const part of fs.readdirSync(folder)) {
    const sub = path.join(folder, part);
    if (!fs.statSync(sub).isDirectory()) continue;
    for (const file of fs.readdirSync(sub).filter((f) => f.endsWith('.sf.jsonl'))) {
      for (const line of fs.readFileSync(path.join(sub, file), 'utf8').split('\n')) {
        const record = line ? JSON.parse(line) : {};
        const hex = record.sf || record.hex || '';
        if (hex) frames.push(Buffer.from(hex, 'hex'));
      }
    }
  }
  if (frames.length === 0) throw new Error(`no captures under ${folder}`);
  return frames;
}

/// The objects that the program prints as JSON lines.
function records(rubric, args, input = '') {
  const done = spawnSync(rubric, args, {input, encoding: 'utf8', maxBuffer: 1 << 28});
  if (done.status > 1) throw new Error(`rubric ${args.join(' ')}: ${done.stderr}`);
  return done.stdout.split('\n').filter(Boolean).map((line) => JSON.parse(line));
}

/// Frames of each message on that carrier, three of ten of them broken.
function madeFrames(rubric, {spec, carrier}, seed) {
  const args = ['generate', '--spec', spec, '--count', '40000', '--seed', String(seed)];
  return records(rubric, args).filter((frame) => frame.carrier === carrier)
      .map(({raw}) => Buffer.from(raw, 'hex'));
}

const pick = (list, random) => list[random.below(list.length)];
const interesting = [0, 1, 2, 3, 9, 10, 16, 22, 23, 24, 25, 34, 35, 36, 92, 93, 100, 102, 103, 113,
  114, 115, 127, 128, 253, 254, 255];

function mutate(frame, random) {
  const out = Buffer.from(frame);
  if (out.length === 0) return out;
  switch (random.below(6)) {
    case 0: return out.subarray(0, random.below(out.length + 1));
    case 1: return Buffer.concat([out, Buffer.alloc(1 + random.below(5), random.below(256))]);
    case 2: case 3: out[random.below(Math.min(out.length, 30))] = pick(interesting, random); break;
    default:
      for (let n = 1 + random.below(4); n > 0; --n) {
        out[random.below(out.length)] ^= 1 << random.below(8);
      }
  }
  return out;
}

// What a line of hex can say: it takes no more, and what begins with a flag for a frame of HDLC.
const isOfHex = (bytes) => bytes.length > 0 && bytes.length <= 255 && bytes[0] !== 0x7e;

/// `count` frames for the suite: {bytes, origin: real, made up or mutated}. The real ones are
/// RUBICON's of the serial line.
function makeFrames(rubric, suite, folder, count, seed) {
  const random = seeded(seed);
  const made = madeFrames(rubric, suite, seed);
  const real = suite.real ? realFrames(folder) : [];
  const frames = real.map((bytes) => ({bytes, origin: 'real'}));
  while (frames.length < count) {
    const fromReal = real.length > 0 && random.chance(0.25);
    const source = pick(fromReal ? real : made, random);
    let bytes = source;
    // A copy of a real frame shows nothing new.
    for (let n = fromReal ? 1 + random.below(2) : random.below(3); n > 0; --n) {
      bytes = mutate(bytes, random);
    }
    const same = bytes.equals(source);
    if (!isOfHex(bytes) || (same && fromReal)) continue;
    frames.push({bytes, origin: same ? 'made up' : 'mutated'});
  }
  return frames;
}

module.exports = {makeFrames, mutate, records, seeded};
