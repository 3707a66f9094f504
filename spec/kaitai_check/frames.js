// Makes frames to compare both decoders on: real ones and made-up messages of every kind, mutated
// where parsers go wrong. Seeded, so a run can be repeated.
'use strict';
const fs = require('fs');
const path = require('path');
const bodies = require('./bodies.js');

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

const amHeaderBytes = 8;
const netHeaderBytes = 12;
const netPayloadMax = 102;
const devidNull = 0xfffd;
const interesting = [0, 1, 2, 3, 9, 10, 16, 22, 23, 24, 25, 34, 35, 36, 92, 93, 100, 102, 103, 113,
  114, 115, 127, 128, 253, 254, 255];

/// A net_msg around a message of an application, or around noise.
function netMessage(random) {
  const [trans, app, fromPc, first, message] = bodies.pick(bodies.applications, random);
  let inner = random.chance(0.85) ? bodies.body(message, random)
      : bodies.noise(random.below(101), random);
  if (inner.length > 0 && first !== null) inner[0] = first;
  // Bytes after the body are left over from earlier frames, within nbytes and after it.
  if (random.chance(0.2)) inner = Buffer.concat([inner, bodies.noise(random.below(20), random)]);
  inner = inner.subarray(0, netPayloadMax - 2);
  const byPc = random.chance(0.05) ? !fromPc : (fromPc ?? random.chance(0.5));
  const head = Buffer.alloc(netHeaderBytes + 2);
  head.writeUInt32BE(0x000bfffd, 0);
  head.writeUInt16BE(0x000b, 4);
  head.writeUInt16BE(byPc ? devidNull : 2, 6);
  head[8] = random.below(2);
  head.writeUInt16BE(random.below(65536), 9);
  head[11] = inner.length + 2;
  head[12] = random.chance(0.05) ? random.below(12) : trans;
  head[13] = random.chance(0.05) ? random.below(12) : app;
  const behind = random.chance(0.3) ? random.below(netPayloadMax - inner.length - 1) : 0;
  return Buffer.concat([head, inner, bodies.noise(behind, random)]);
}

/// A message that travels as an AM type of its own: {type, payload}.
function ownType(types, random) {
  const [type, message] = bodies.pick(types, random);
  const payload = bodies.body(message, random);
  const behind = random.chance(0.3) ? bodies.noise(random.below(12), random) : Buffer.alloc(0);
  return {type: random.chance(0.05) ? random.below(256) : type,
    payload: Buffer.concat([payload, behind])};
}

const message = (types, netShare, random) => random.chance(netShare)
    ? {type: 28, payload: netMessage(random)} : ownType(types, random);

function serialFrame({type, payload}, random) {
  const head = bodies.noise(amHeaderBytes, random);
  head[0] = 0;
  head[5] = payload.length;
  head[7] = type;
  return Buffer.concat([head, payload]);
}

function radioFrame({type, payload}, network, random) {
  const head = bodies.noise(network ? 11 : 10, random);
  head.writeUInt16LE(0x8841, 0);
  if (network) head[9] = 0x3f;
  head[head.length - 1] = type;
  return Buffer.concat([head, payload]);
}

/// The parts of each carrier's frames: a fresh frame, and the bytes where parsers go wrong.
const makers = {
  serial: {
    fresh: (random) => serialFrame(message(bodies.serialTypes, 0.8, random), random),
    headers: [0, 5, 7], net: amHeaderBytes,
  },
  oscilloscope: {
    fresh: (random) => serialFrame(ownType(bodies.oscilloscopeTypes, random), random),
    headers: [0, 5, 7], net: null,
  },
  radio_i_frame: {
    fresh: (random) => radioFrame(message(bodies.radioTypes, 0.4, random), true, random),
    headers: [9, 10], net: 11,
  },
  radio_t_frame: {
    fresh: (random) => radioFrame(message(bodies.radioTypes, 0.4, random), false, random),
    headers: [9], net: 10,
  },
};

function mutate(frame, {headers, net}, random) {
  const out = Buffer.from(frame);
  const set = (at, value) => {
    if (at < out.length) out[at] = value;
  };
  const odd = () => bodies.pick(interesting, random);
  switch (random.below(9)) {
    case 0: return out.subarray(0, random.below(out.length + 1));
    case 1: return Buffer.concat([out, Buffer.alloc(1 + random.below(5), random.below(256))]);
    case 2: set(bodies.pick(headers, random), random.chance(0.5) ? odd() : random.below(40)); break;
    case 3: if (net) set(net + 11, odd()); break;                                     // nbytes
    case 4: if (net) set(net + 8, random.below(random.chance(0.5) ? 3 : 256)); break;  // reliable
    case 5: if (net) set(net + 12 + random.below(4), random.below(40)); break;
    default:
      for (let n = 1 + random.below(4); n > 0 && out.length > 0; --n) {
        out[random.below(out.length)] ^= 1 << random.below(8);
      }
  }
  return out;
}

/// `count` frames of at least one byte for that carrier: {bytes, origin: real, made up or mutated}.
/// The real ones are of the serial line.
function makeFrames(carrier, folder, count, seed) {
  const random = seeded(seed);
  const maker = makers[carrier];
  const real = carrier === 'serial' ? realFrames(folder) : [];
  const frames = real.map((bytes) => ({bytes, origin: 'real'}));
  while (frames.length < count) {
    const fromReal = real.length > 0 && random.chance(0.25);
    const source = fromReal ? bodies.pick(real, random) : maker.fresh(random);
    let bytes = source;
    // A copy of a real frame shows nothing new.
    for (let n = fromReal ? 1 + random.below(2) : random.below(3); n > 0; --n) {
      bytes = mutate(bytes, maker, random);
    }
    const same = bytes.equals(source);
    if (bytes.length === 0 || (same && fromReal)) continue;
    frames.push({bytes, origin: same ? 'made up' : 'mutated'});
  }
  return frames;
}

module.exports = {makeFrames, seeded};
