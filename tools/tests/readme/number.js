// The numbers of README.md, for the tests that count them; see number.h.
'use strict';
const assert = require('node:assert');
const fs = require('node:fs');
const path = require('node:path');

/// The number that README.md has at the '#' of `words`: 804 for "# [vectors]".
exports.readmeNumber = (words) => {
  const readme = fs.readFileSync(path.join(__dirname, '../../../README.md'), 'utf8');
  const [before, after] = words.split('#').map((part) => part.replace(/[^\w\s]/g, '\\$&'));
  const wanted = new RegExp(`${before}(?<![\\d,])(\\d[\\d,]*)(?<!,)${after}`, 'g');
  const found = [...readme.replace(/\s+/g, ' ').matchAll(wanted)];
  assert.equal(found.length, 1, `README.md does not say exactly once: ${words}`);
  return Number(found[0][1].replaceAll(',', ''));
};
