#!/bin/sh
# compile_freestanding.sh FOLDER COMPILER FLAG...: the runtime and every generated header, as
# firmware compiles them.
set -u
folder=$1 compiler=$2
shift 2
if ! command -v "$compiler" >/dev/null; then
  echo "$compiler is missing; tools/install-packages installs what the tests need."
  exit 1
fi
object=$(mktemp)
trap 'rm -f "$object"' EXIT
for source in codec/runtime/freestanding.cc codec/tests/every_codec.cc; do
  "$compiler" "$@" -ffreestanding -fno-exceptions -fno-rtti -Wall -Wextra -Wshadow -Werror \
    -I "$folder" -c "$folder/$source" -o "$object" || exit 1
  echo "$compiler $*: $source is $(wc -c < "$object") bytes of object"
  test -s "$object" || exit 1
done
headers=$(find "$folder/codec/generated" -name '*.h' ! -name '*table*' ! -name messages.h | wc -l)
echo "$headers generated headers"
test "$headers" -ge 50
