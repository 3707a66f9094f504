// Compares a decoded record's fields and stale bytes with the object that Kaitai Struct's parser
// made of the frame.
'use strict';

class Disagreement extends Error {}
const camel = (name) => name.replace(/_(\w)/g, (_, c) => c.toUpperCase());
const snake = (name) => name.replace(/([A-Z])/g, (c) => '_' + c.toLowerCase()).replace(/^_/, '');
const isBytes = (value) => value instanceof Uint8Array;

class Comparer {
  constructor(specs) {
    this.types = Object.assign({}, ...specs.map((s) => s.types));
    this.enums = Object.assign({}, ...specs.map((s) => s.enums || {}));
  }

  typeOf(object) {
    const name = snake(object.constructor.name);
    if (!this.types[name]) throw new Error(`no type ${name} in the spec`);
    return {name, ...this.types[name]};
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
    this.structure(record.fields, object, record.path[0]);
    this.unread.sort((a, b) => a.byteOffset - b.byteOffset);
    this.same(record.stale, Buffer.concat(this.unread).toString('hex'), 'stale');
  }

  /// Notes what the object left unread, where it has bytes of its own. To be done before any of its
  /// instances is asked for: one that does not fit leaves the stream where it failed.
  noteUnread(object) {
    const io = object._io;
    if (object._parent && object._parent._io === io) return;
    this.unread.push(Buffer.from(io._buffer, io.byteOffset + io.pos, io.size - io.pos));
  }

  structure(json, object, where) {
    this.noteUnread(object);
    const type = this.typeOf(object);
    const wanted = new Set();
    const body = this.interpretation(object, type);
    for (const field of type.seq) {
      const overlaid = body && field['size-eos'] && !field.type;
      const key = overlaid ? 'body' : field.id;
      wanted.add(key).add(`${key}_name`).add(`${key}_bits`);
      if (!(key in json)) throw new Disagreement(`${where}.${key}: missing`);
      if (overlaid) {
        this.structure(json.body, body.object, `${where}.body`);
      } else {
        this.field(json, field, object[camel(field.id)], `${where}.${field.id}`);
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
      names.unshift(bit.id);
    });
    return {number, names};
  }

  single(given, value, field, where) {
    if (isBytes(value)) return this.same(given, Buffer.from(value).toString('hex'), where);
    if (typeof value === 'number') return this.number(given, value, field, where);
    const mask = this.mask(value);
    if (mask) return this.same(given, mask.number, where);
    return this.structure(given, value, where);
  }

  number(given, value, field, where) {
    const expected = Number.isFinite(value) ? value : String(value);
    // A float is printed as short as binary32 allows; Kaitai gives it as a binary64.
    const isFloat = String(field.type).startsWith('f4') && typeof given === 'number';
    return this.same(isFloat ? Math.fround(given) : given, expected, where);
  }

  same(got, expected, where) {
    if (got !== expected) throw new Disagreement(`${where}: rubric ${got}, Kaitai ${expected}`);
  }
}

module.exports = {Comparer, Disagreement};
