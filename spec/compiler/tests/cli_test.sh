#!/bin/sh
# Exit codes of rubricc, and no files left over after a mistake.
# usage: spec/compiler/tests/cli_test.sh RUBRICC   (in the project's folder)
set -u
rubricc=$1
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
failures=0

expect() {  # expect CODE ARGUMENT...
  code=$1
  shift
  "$rubricc" "$@" >"$out/stdout" 2>"$out/stderr"
  got=$?
  if [ "$got" -ne "$code" ]; then
    echo "rubricc $*: exit $got, expected $code"
    cat "$out/stderr"
    failures=$((failures + 1))
  fi
}

good=spec/wire/tinyos.ksy
bad=spec/compiler/tests/bad/many_mistakes.ksy
expect 0 --check $good
expect 0 --help
expect 66 --requirements "$out/nothing.yaml" --check $good
grep -q -- '--requirements names another' "$out/stderr" || { echo "no hint"; failures=1; }
cat >"$out/lamp.ksy" <<'END'
meta: {id: lamp, endian: be}
types:
  light: {-am-type: 0x2a, -requirement: LAMP, seq: [{id: level, type: u1}]}
END
cat >"$out/own.yaml" <<'END'
- {id: LAMP, level: MUST, clause: "wire, messages", sentence: "A light is a byte.", source: ours}
END
expect 0 --requirements "$out/own.yaml" --check "$out/lamp.ksy"
expect 0 --requirements "$out/own.yaml" --emit cpp,lua --out "$out/lamp" "$out/lamp.ksy"
grep -q 'no dissector' "$out/stderr" || { echo "a missing dissector is not said"; failures=1; }
expect 0 --emit tables --out "$out/good" $good
[ -f "$out/good/codec/generated/tinyos/tables.h" ] || { echo "no tables"; failures=1; }
expect 0 --emit json --out "$out/json" $good
grep -q '"schema": "rubricc.model/1"' "$out/json/doc/wire.json" ||
  { echo "no model as JSON"; failures=1; }
expect 1 --check $bad
grep -q 'many_mistakes.ksy:43:5: error: duplicate enum value 2' "$out/stderr" ||
  { echo "the diagnostics are not on stderr"; failures=1; }
expect 1 --emit tables --out "$out/bad" $bad
[ ! -e "$out/bad" ] || { echo "files in spite of mistakes"; failures=1; }
expect 0 --emit profiles,cases --cases "$out/none" --out "$out/good" $good
for file in profiles cases; do
  [ -f "$out/good/conformance/generated/$file.h" ] || { echo "no $file"; failures=1; }
done
expect 1 --check --profiles spec/compiler/tests/bad/profiles $good
grep -q 'profiles/mistakes.yaml:26:24: error: ' "$out/stderr" ||
  { echo "profiles are not checked"; failures=1; }
expect 1 --check --cases spec/compiler/tests/bad/cases $good
grep -q 'cases/no_name.rtr:4:1: error: ' "$out/stderr" ||
  { echo "cases are not checked"; failures=1; }
expect 64
expect 64 $good
expect 64 --emit tables $good
expect 64 --emit poetry --out "$out" $good
expect 64 --check --emit tables --out "$out" $good
expect 66 --check spec/wire/nothing.ksy
expect 66 --check --requirements nothing.yaml $good
expect 66 --emit profiles --profiles nothing --out "$out" $good
expect 74 --emit tables --out /dev/null/nowhere $good
exit "$failures"
