#!/bin/sh
# must_not_compile.sh COMPILER SOURCE INCLUDE_FOLDER DEFINE REGEX: compiling SOURCE with -DDEFINE must
# fail with a message that matches, and must succeed without, so that it fails for no other reason.
set -u
compiler=$1 source=$2 include=$3 define=$4 expected=$5
flags="-std=c++20 -c -o /dev/null -I $include"

if ! output=$("$compiler" $flags "$source" 2>&1); then
  printf 'The control build of %s fails:\n%s\n' "$source" "$output"
  exit 1
fi
if output=$("$compiler" $flags "-D$define" "$source" 2>&1); then
  echo "$source compiles with -D$define, and must not."
  exit 1
fi
if ! printf '%s\n' "$output" | grep -Eq -- "$expected"; then
  printf '%s fails, but not with a message like "%s":\n%s\n' "$source" "$expected" "$output"
  exit 1
fi
printf 'Refused as it must be: %s\n' "$(printf '%s\n' "$output" | grep -E -m1 -- "$expected")"
