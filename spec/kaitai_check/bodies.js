// The form of a message's bytes when they are right: its size, and the place of its count.
'use strict';

/// A message: `fixed` bytes, then `each` bytes for every one that the byte `countAt` counts.
/// `limits`: bytes with a greatest value of their own.
const plain = (fixed, limits = {}) => ({fixed, each: 0, limits});
const counted = (fixed, countAt, each, most) => ({fixed, countAt, each, most, limits: {}});

const synCreate = plain(58, {13: 10, 34: 10});
const moduleCmd = counted(8, 7, 1, 92);
const moduleFloatCmd = counted(8, 7, 4, 23);

/// [TRANSID, APPID, sent by the PC (null: by anyone), first byte (null: any), message]
const applications = [
  [3, 10, null, 16, plain(9)], [3, 10, null, 35, counted(2, 1, 4, 24)],
  [3, 10, null, 36, plain(5)],
  [3, 5, null, 1, plain(5)], [3, 5, null, 34, plain(19)], [3, 5, null, 36, plain(5)],
  [3, 6, false, 23, plain(4)], [3, 6, false, 24, counted(4, 3, 4, 23)],
  [3, 6, false, 25, counted(2, 1, 4, 24)],
  [3, 6, true, 8, plain(5)],
  [3, 6, true, 9, synCreate], [3, 6, true, 10, synCreate], [3, 6, true, 11, synCreate],
  [3, 6, true, 12, moduleCmd], [3, 6, true, 16, moduleCmd], [3, 6, true, 18, moduleCmd],
  [3, 6, true, 20, moduleFloatCmd], [3, 6, true, 22, moduleFloatCmd],
  [3, 6, true, 28, moduleFloatCmd], [3, 6, true, null, plain(5)],
  [9, 6, null, null, plain(4)], [9, 6, null, null, plain(2)],
  [1, 11, null, null, plain(4)], [1, 11, null, null, plain(40)],
];

/// AM types of the serial line and of the radio, without network messages.
const serialTypes = [[11, plain(5)], [12, plain(13)], [20, moduleCmd], [21, moduleFloatCmd],
  [37, plain(3)]];
const radioTypes = [[6, plain(1)], [14, plain(6)], [15, plain(10)], [29, plain(14)]];
const oscilloscopeTypes = [[0x93, plain(28)]];

const pick = (list, random) => list[random.below(list.length)];
const noise = (size, random) =>
  Buffer.from(Array.from({length: size}, () => random.below(256)));

/// The bytes of such a message; its size and counts are mostly right, sometimes just beside it.
function body(message, random) {
  const count = message.each ? random.below(message.most + (random.chance(0.9) ? 1 : 4)) : 0;
  let size = message.fixed + count * message.each;
  if (random.chance(0.15)) size = Math.max(0, size + random.below(7) - 3);
  const out = noise(size, random);
  if (message.each && message.countAt < size) out[message.countAt] = count;
  for (const [at, most] of Object.entries(message.limits)) {
    if (at < size && random.chance(0.9)) out[at] = random.below(most + 1);
  }
  return out;
}

module.exports = {applications, serialTypes, radioTypes, oscilloscopeTypes, body, noise, pick};
