#!/bin/sh
# compile_freestanding.sh FOLDER COMPILER FLAG...: every generated header, as firmware compiles it.
set -u
folder=$1 compiler=$2
shift 2
if ! command -v "$compiler" >/dev/null; then
  echo "$compiler is missing; tools/test needs it (see README.md for the packages)."
  exit 1
fi
object=$(mktemp)
trap 'rm -f "$object"' EXIT
"$compiler" "$@" -ffreestanding -fno-exceptions -fno-rtti -Wall -Wextra -Wshadow -Werror \
  -I "$folder" -c "$folder/codec/codec_test/every_codec.cc" -o "$object" || exit 1
headers=$(find "$folder/codec/generated" -name '*.h' ! -name '*table*' ! -name messages.h | wc -l)
echo "$compiler $*: $headers generated headers compile, $(wc -c < "$object") bytes of object"
test "$headers" -ge 50 && test -s "$object"
