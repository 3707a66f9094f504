#!/bin/sh
# includes_test.sh FOLDER: the codec that firmware uses includes itself and C headers, nothing else;
# and every header of the runtime and of the generated code compiles alone.
set -u
cd "$1" || exit 1
command -v g++ >/dev/null || { echo "g++ is missing; see tools/install-packages"; exit 1; }
firmware=$(find codec/generated -name '*.h' ! -name '*table*' ! -name messages.h)
firmware="$firmware $(find codec/runtime -name '*.h')"
allowed='"codec/(runtime|generated)/[a-z0-9_/]+\.h"|<(stdint|stddef|string|assert)\.h>'
# Hosts with C++20 also get <span>, after a check of the preprocessor.
host='^codec/runtime/bytes.h:[0-9]+:#include <span>$'
found=$(grep -n '#include' $firmware | grep -Ev "#include ($allowed)\$|$host")
lines=$(cat $firmware | grep -c '#include')
if [ -n "$found" ]; then
  printf 'These include what a mote does not have:\n%s\n' "$found"
  exit 1
fi
all=$(find codec/generated codec/runtime -name '*.h')
for header in $all; do
  # As a unit of its own, since a header as the main file is warned of.
  echo "#include \"$header\"" |
    g++ -std=c++14 -Wall -Wextra -Wshadow -Wconversion -Werror -I . -fsyntax-only -x c++ - || {
      echo "$header does not compile alone"
      exit 1
    }
done
echo "$lines includes in $(echo $firmware | wc -w) headers; $(echo $all | wc -w) compile alone"
test "$lines" -ge 100 && test "$(echo $all | wc -w)" -ge 60
