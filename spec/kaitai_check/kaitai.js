// Compiles the wire spec with Kaitai Struct's own compiler and loads the parsers that it makes.
'use strict';
const fs = require('fs');
const os = require('os');
const path = require('path');
const yaml = require('js-yaml');
const compiler = require('kaitai-struct-compiler');

/// rubric's names of the errors of Kaitai Struct's runtime.
const faultOfError = {
  EOFError: 'truncated',
  ValidationNotEqualError: 'unexpected',
  ValidationNotAnyOfError: 'unexpected',
  ValidationNotInEnumError: 'unexpected',
  ValidationLessThanError: 'out_of_range',
  ValidationGreaterThanError: 'out_of_range',
};

let positionsTold = false;
const wireFolder = path.join(__dirname, '..', 'wire');

/// Returns where the spec is: with those that code is made from, or that are read at run time, or
/// here.
function fileOf(name) {
  return [wireFolder, path.join(wireFolder, 'run_time'), __dirname]
      .map((folder) => path.join(folder, `${name}.ksy`)).find((file) => fs.existsSync(file));
}

function readSpec(name) {
  return yaml.load(fs.readFileSync(fileOf(name), 'utf8'));
}

/// Makes errors of Kaitai Struct's runtime report their place, which it knows: with `io` and, for a
/// value that is not valid, `srcPath`, its place in the spec.
function tellPositions(Stream) {
  const {ensureBytesLeft} = Stream.prototype;
  Stream.prototype.ensureBytesLeft = function(length) {
    try {
      ensureBytesLeft.call(this, length);
    } catch (error) {
      throw Object.assign(error, {io: this});
    }
  };
  for (const name of Object.keys(Stream).filter((key) => key.startsWith('Validation'))) {
    const Silent = Stream[name];
    Stream[name] = function(...details) {
      const [io, srcPath] = details.slice(-2);
      return Object.assign(new Silent(...details), {io, srcPath});
    };
  }
}

/// {parser: constructor, spec: the spec as an object, Stream: KaitaiStream}
async function load(name) {
  const spec = readSpec(name);
  const files = await compiler.compile('javascript', spec,
      {importYaml: async (imported) => readSpec(imported)}, false);
  const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'rubric-kaitai-'));
  fs.symlinkSync(path.join(__dirname, 'node_modules'), path.join(folder, 'node_modules'));
  for (const [file, text] of Object.entries(files)) {
    fs.writeFileSync(path.join(folder, file), text);
  }
  const className = name[0].toUpperCase() +
      name.slice(1).replace(/_(\w)/g, (_, c) => c.toUpperCase());
  const parser = require(path.join(folder, `${className}.js`))[className];
  const Stream = require('kaitai-struct/KaitaiStream');
  if (!positionsTold) tellPositions(Stream);
  positionsTold = true;
  fs.rmSync(folder, {recursive: true});
  return {parser, spec, Stream};
}

module.exports = {faultOfError, fileOf, load};
