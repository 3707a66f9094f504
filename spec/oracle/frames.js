// Makes frames to hold both decoders against: real ones and made-up bodies of every kind, mutated
// where parsers go wrong. Seeded, so a run can be repeated.
'use strict';
const fs = require('fs');
const path = require('path');

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
  return frames;
}

const amHeaderBytes = 8;
const netHeaderBytes = 12;
const interesting = [0, 1, 2, 3, 9, 10, 16, 22, 23, 24, 25, 34, 35, 36, 92, 93, 100, 102, 103, 113,
  114, 115, 127, 128, 253, 254, 255];

/// A net_msg with a body whose kind, size and counts are near what the protocol knows.
function madeUp(random) {
  const size = random.chance(0.3) ? 100 : random.below(101);
  const body = Buffer.from(Array.from({length: size}, () => random.below(256)));
  const kinds = [1, 8, 9, 10, 11, 12, 13, 16, 18, 20, 22, 23, 24, 25, 28, 34, 35, 36];
  if (size > 0) body[0] = kinds[random.below(kinds.length)];
  for (const at of [1, 3, 7, 13, 34]) {  // Where counts stand in one body or another.
    if (at < size && random.chance(0.7)) body[at] = random.below(26);
  }
  const frame = Buffer.alloc(amHeaderBytes + netHeaderBytes + 2 + size);
  frame.writeUInt16BE(0xffff, 1);
  frame[5] = frame.length - amHeaderBytes;
  frame[7] = 28;
  frame.writeUInt32BE(0x000bfffd, 8);
  frame.writeUInt32BE(random.chance(0.5) ? 0x000bfffd : 0x000b0002, 12);
  frame[16] = random.below(2);
  frame.writeUInt16BE(random.below(65536), 17);
  frame[19] = size + 2;
  frame[20] = [3, 3, 3, 1, 9, random.below(12)][random.below(6)];
  frame[21] = [5, 6, 6, 10, 11, random.below(12)][random.below(6)];
  body.copy(frame, 22);
  return frame;
}

/// A message that travels as an AM type of its own.
function otherType(random) {
  const types = [[11, 5], [12, 13], [20, 100], [21, 100], [37, 3], [random.below(256), 20]];
  const [type, least] = types[random.below(types.length)];
  const size = Math.max(0, least - 2 + random.below(20)) % 115;
  const frame = Buffer.from(Array.from({length: amHeaderBytes + size}, () => random.below(256)));
  frame[0] = 0;
  frame[5] = size;
  frame[7] = type;
  if (size > 7 && random.chance(0.7)) frame[15] = random.below(100);
  return frame;
}

function mutate(frame, random) {
  const out = Buffer.from(frame);
  switch (random.below(10)) {
    case 0: return out.subarray(0, random.below(out.length + 1));
    case 1: return Buffer.concat([out, Buffer.alloc(1 + random.below(5), random.below(256))]);
    case 2: if (out.length > 5) out[5] = interesting[random.below(interesting.length)]; break;
    case 3: if (out.length > 19) out[19] = interesting[random.below(interesting.length)]; break;
    case 4: if (out.length > 16) out[16] = random.below(random.chance(0.5) ? 3 : 256); break;
    case 5: out[random.chance(0.3) ? 0 : out.length - 1] ^= 1 << random.below(8); break;
    case 6: if (out.length > 7) out[7] = random.below(40); break;
    case 7: if (out.length > 23) out[20 + random.below(4)] = random.below(40); break;
    default:
      for (let n = 1 + random.below(4); n > 0 && out.length > 0; --n) {
        out[random.below(out.length)] ^= 1 << random.below(8);
      }
  }
  return out;
}

/// `count` frames of at least one byte, from the dispatch byte on.
function makeFrames(folder, count, seed) {
  const random = seeded(seed);
  const real = realFrames(folder);
  if (real.length === 0) throw new Error(`no captures under ${folder}`);
  const frames = [...real];
  while (frames.length < count) {
    const kind = random.below(10);
    let frame = kind < 3 ? real[random.below(real.length)]
        : kind < 8 ? madeUp(random) : otherType(random);
    for (let n = random.below(3); n > 0; --n) frame = mutate(frame, random);
    if (frame.length > 0) frames.push(frame);
  }
  return frames;
}

module.exports = {makeFrames};
