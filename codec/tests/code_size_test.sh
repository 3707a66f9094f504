#!/bin/sh
# code_size_test.sh FOLDER BOUND: what a mote's messages take on an ATmega128, in bytes. Raise the
# bound only with a reason.
set -u
folder=$1 bound=$2
for tool in avr-g++ avr-nm avr-size; do
  command -v $tool >/dev/null && continue
  echo "$tool is missing; tools/install-packages installs what the tests need."
  exit 1
done
object=$(mktemp)
trap 'rm -f "$object"' EXIT
avr-g++ -mmcu=atmega128 -std=c++14 -Os -DNDEBUG -fno-exceptions -fno-rtti -ffunction-sections \
  -fdata-sections -Wall -Wextra -Werror -I "$folder" \
  -c "$folder/codec/tests/mote_use.cc" -o "$object" || exit 1
avr-nm -S --radix=d "$object" | awk '
  NF == 4 && $3 ~ /[tTwWvV]/ {
    name = $4
    if (name !~ /_(parse|write|view)$/ || name ~ /^_Z/) name = "shared"
    size[name] += $2
  }
  END { for (name in size) printf "%6d  %s\n", size[name], name }' | sort -k2
# Inline functions are sections of their own, which avr-size -A lists and -B leaves out of text.
avr-size -A "$object" | awk -v bound="$bound" '
  $1 ~ /^\.text/ { text += $2 }
  $1 ~ /^\.(data|rodata)/ { data += $2 }
  $1 ~ /^\.bss/ { bss += $2 }
  END {
    printf "text %d, data %d, bss %d bytes; at most %d of text and none of the others\n",
           text, data, bss, bound
    exit !(text > 1000 && text <= bound && data == 0 && bss == 0)
  }'
