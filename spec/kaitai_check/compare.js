// Compares a decoded record's fields and stale bytes with the object that Kaitai Struct's parser
// made of the frame.
'use strict';

class Disagreement extends Error {}
const camel = (name) => name.replace(/_(\w)/g, (_, c) => c.toUpperCase());
const pascal = (name) => name[0].toUpperCase() + camel(name).slice(1);
const isBytes = (value) => value instanceof Uint8Array;

/// Types of a spec by id, those within types, too.
function typesOf(spec) {
  const types = spec.seq ? {[spec.meta.id]: spec} : {};
  const add = (more) => Object.entries(more || {}).forEach(([id, type]) => {
    types[id] = type;
    add(type.types);
  });
  add(spec.types);
  return types;
}

class Comparer {
  constructor(specs) {
    const types = Object.entries(Object.assign({}, ...specs.map(typesOf)));
    this.types = Object.fromEntries(types.map(([id, type]) => [pascal(id), type]));
    this.enums = Object.assign({}, ...specs.map((s) => s.enums), ...types.map(([, t]) => t.enums));
  }

  typeOf(object) {
    const {name} = object.constructor;
    if (!this.types[name]) throw new Error(`no type ${name} in the spec`);
    return this.types[name];
  }

  /// The first interpretation that fits, as Kaitai sees it: {id, object}, or null.
  interpretation(object, type) {
    for (const [id, instance] of Object.entries(type.instances || {})) {
      if (!instance['-name']) continue;
      try {
        const value = object[camel(id)];
        if (value !== undefined && !isBytes(value)) return {id, object: value};
      } catch (error) {
        // Does not fit: the next one may.
      }
    }
    return null;
  }

  /// Fields and stale bytes of a record whose outermost message is `object`.
  message(record, object) {
    this.unread = [];
    this.noted = new Set();
    // What Kaitai makes of bytes that are no text is its own affair.
    this.isText = !record.notes.some(({note}) => note === 'not_text');
    this.structure(record.fields, object, record.path[0]);
    this.unread.sort((a, b) => a.byteOffset - b.byteOffset);
    this.same(record.stale, Buffer.concat(this.unread).toString('hex'), 'stale');
  }

  /// Notes what the object left unread, where it has bytes of its own. To be done before any of its
  /// instances is asked for: one that does not fit leaves the stream where it failed.
  noteUnread(object) {
    const io = object._io;
    if (this.noted.has(io)) return;
    this.noted.add(io);
    this.unread.push(Buffer.from(io._buffer, io.byteOffset + io.pos, io.size - io.pos));
  }

  structure(json, object, where) {
    this.noteUnread(object);
    const type = this.typeOf(object);
    const wanted = new Set();
    const body = this.interpretation(object, type);
    for (const field of type.seq || []) {
      const overlaid = body && field['size-eos'] && !field.type;
      const key = overlaid ? 'body' : field.id;
      const value = overlaid ? body.object : object[camel(field.id)];
      ['', '_name', '_bits', '_hex'].forEach((suffix) => wanted.add(key + suffix));
      this.same(key in json, value !== undefined, `${where}.${key} is there`);
      if (overlaid) {
        this.structure(json.body, value, `${where}.body`);
      } else if (value !== undefined) {
        this.field(json, field, value, `${where}.${key}`);
      }
    }
    for (const key of Object.keys(json)) {
      if (!wanted.has(key)) throw new Disagreement(`${where}.${key}: Kaitai has no such field`);
    }
  }

  field(json, field, value, where) {
    const given = json[field.id];
    if (field.repeat) {
      this.same(given.length, value.length, `${where} length`);
      value.forEach((v, i) => this.single(given[i], v, field, `${where}[${i}]`));
      return;
    }
    this.single(given, value, field, where);
    if (field.enum) {
      const names = this.enums[field.enum.split('::').pop()];
      const name = value in names ? String(names[value].id ?? names[value]) : null;
      this.same(json[`${field.id}_name`], name, `${where}_name`);
    }
    const mask = this.mask(value);
    if (mask) this.same(String(json[`${field.id}_bits`]), String(mask.names), `${where}_bits`);
  }

  /// {number, names from the lowest bit up} of a mask object, or null.
  mask(value) {
    if (typeof value !== 'object' || isBytes(value) || Array.isArray(value)) return null;
    const type = this.typeOf(value);
    if (!type['-mask']) return null;
    const width = type.seq.length;
    let number = 0;
    const names = [];
    type.seq.forEach((bit, i) => {
      if (!value[camel(bit.id)]) return;
      number += 2 ** (width - 1 - i);
      names.unshift(bit['-unnamed'] ? `bit${width - 1 - i}` : bit.id);
    });
    return {number, names};
  }

  single(given, value, field, where) {
    if (isBytes(value)) {
      // A terminator is part of the bytes that rubric shows, and no part of Kaitai's.
      const hex = Buffer.from(value).toString('hex');
      if (field.repeat) return this.same(given, value[0], where);  // One by one they are numbers.
      return this.same('terminator' in field && given === hex + '0a' ? hex : given, hex, where);
    }
    if (typeof value === 'boolean') return this.same(given, value ? 1 : 0, where);
    if (typeof value === 'string') return this.isText && this.same(given, value, where);
    if (typeof value === 'number') return this.number(given, value, field, where);
    const mask = this.mask(value);
    if (mask) return this.same(given, mask.number, where);
    return this.structure(given, value, where);
  }

  number(given, value, field, where) {
    const expected = Number.isFinite(value) ? value : String(value);
    // A float is printed as short as binary32 allows; Kaitai gives it as a binary64.
    const isFloat = String(field.type).startsWith('f4') && typeof given === 'number';
    // Of 64 bits both are doubles here. Kaitai's readS8 takes the low half of a negative number for
    // signed, which is off by 2^32 for every second one, and rounds twice.
    const isBelow = String(field.type).startsWith('s8') && expected < 0;
    if (isBelow && Math.abs(given - expected) <= 2 ** 32 + 2 ** 11) return null;
    return this.same(isFloat ? Math.fround(given) : given, expected, where);
  }

  same(got, expected, where) {
    if (got !== expected) throw new Disagreement(`${where}: rubric ${got}, Kaitai ${expected}`);
  }
}

module.exports = {Comparer, Disagreement, pascal, typesOf};
