#!/bin/sh
# must_not_compile.sh COMPILER SOURCE INCLUDE_FOLDER [DEFINE REGEX]...: compiling SOURCE with each
# -DDEFINE must fail with a message that matches, and must succeed without, so that it fails for no
# other reason.
set -u
compiler=$1 source=$2 include=$3
shift 3
flags="-std=c++20 -c -o /dev/null -I $include"

if ! output=$("$compiler" $flags "$source" 2>&1); then
  printf 'The control build of %s fails:\n%s\n' "$source" "$output"
  exit 1
fi
failed=0
while [ $# -gt 0 ]; do
  define=$1 expected=$2
  shift 2
  if output=$("$compiler" $flags "-D$define" "$source" 2>&1); then
    echo "$source compiles with -D$define, and must not."
    failed=1
  elif ! printf '%s\n' "$output" | grep -Eq -- "$expected"; then
    printf '%s with -D%s fails, but not with a message like "%s":\n%s\n' "$source" "$define" \
      "$expected" "$output"
    failed=1
  else
    printf 'Refused as it must be: %s\n' "$(printf '%s\n' "$output" | grep -E -m1 -- "$expected")"
  fi
done
exit $failed
