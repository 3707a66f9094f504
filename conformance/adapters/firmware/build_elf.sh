#!/bin/sh
# build_elf.sh PROJECT_FOLDER avr|arm OUT.elf [FLAG...]: the firmware in this script's tree, which
# may be a copy of the project's folder conformance.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
project=$1 port=$2 out=$3
shift 3
case $port in
  avr) compiler=avr-g++ flags="-mmcu=atmega128 -flto" ;;
  arm) compiler=arm-none-eabi-g++
    flags="-mcpu=cortex-m3 -mthumb -fno-use-cxa-atexit -nostartfiles --specs=nano.specs
      -T $here/arm/lm3s6965.ld" ;;
  *) echo "usage: build_elf.sh PROJECT_FOLDER avr|arm OUT.elf [FLAG...]" >&2; exit 2 ;;
esac
# Headers of this tree before those of the project.
includes=$(mktemp -d)
trap 'rm -rf "$includes"' EXIT
ln -s "$(dirname "$(dirname "$here")")" "$includes/conformance"
# shellcheck disable=SC2086,SC2046
"$compiler" $flags -std=c++14 -Os -DNDEBUG -ffreestanding -fno-exceptions -fno-rtti \
  -fno-threadsafe-statics -ffunction-sections -fdata-sections -Wl,--gc-sections \
  -Wall -Wextra -Wshadow -Werror "$@" -I "$includes" -I "$project" \
  $(find "$here/bench" "$here/$port" -name '*.cc' ! -name '*_test.cc' | sort) -o "$out"
