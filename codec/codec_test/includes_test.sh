#!/bin/sh
# includes_test.sh FOLDER: the codec that firmware uses includes itself and C headers, nothing else.
set -u
cd "$1" || exit 1
files=$(find codec/generated -name '*.h' ! -name '*table*' ! -name messages.h)
files="$files codec/runtime/view.h codec/runtime/message_codec.h"
allowed='"codec/(runtime|generated)/[a-z0-9_/]+\.h"|<(stdint|stddef|string|assert)\.h>'
found=$(grep -n '#include' $files | grep -Ev "#include ($allowed)\$")
lines=$(cat $files | grep -c '#include')
if [ -n "$found" ]; then
  printf 'These include what a mote does not have:\n%s\n' "$found"
  exit 1
fi
echo "$lines includes in $(echo $files | wc -w) headers"
test "$lines" -ge 100
