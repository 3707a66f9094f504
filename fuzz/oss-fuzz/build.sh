#!/usr/bin/env bash
# Builds every fuzz target into $OUT, with the compiler, flags and engine that the environment
# names: as OSS-Fuzz and ClusterFuzzLite call it, for libFuzzer, AFL++ and honggfuzz.
# $SRC/rubric is this project. What it needs is built the same way where its source is in $SRC (a
# target's libraries need its C++ library and its sanitizer); else the system's is taken.
set -euo pipefail

project=$SRC/rubric
build=$WORK/rubric
installed=$WORK/installed
export CMAKE_BUILD_PARALLEL_LEVEL=${CMAKE_BUILD_PARALLEL_LEVEL:-$(nproc)}

if [ -d "$SRC/fmt" ]; then
  # fmt 9 checks formats at compile time in a way that newer clangs do not take; yaml-cpp 0.7 has
  # std::uint16_t without its header.
  export CXXFLAGS="$CXXFLAGS -DFMT_CONSTEVAL= -include cstdint -isystem $installed/include"
fi
for library in fmt yaml-cpp json CLI11; do
  [ -d "$SRC/$library" ] || continue
  cmake -S "$SRC/$library" -B "$WORK/$library" -G Ninja -Wno-dev \
    -DCMAKE_POLICY_VERSION_MINIMUM=3.5 -DCMAKE_POSITION_INDEPENDENT_CODE=ON \
    -DCMAKE_INSTALL_PREFIX="$installed" -DBUILD_SHARED_LIBS=OFF -DBUILD_TESTING=OFF \
    -DFMT_TEST=OFF -DFMT_DOC=OFF -DYAML_BUILD_SHARED_LIBS=OFF -DYAML_CPP_BUILD_TESTS=OFF \
    -DYAML_CPP_BUILD_TOOLS=OFF -DJSON_BuildTests=OFF -DCLI11_BUILD_TESTS=OFF \
    -DCLI11_BUILD_EXAMPLES=OFF -DCLI11_BUILD_DOCS=OFF
  cmake --build "$WORK/$library" --target install
done

# Libraries that a runner may lack are copied beside the targets, which look for them there.
cmake -S "$project" -B "$build" -G Ninja -DCMAKE_PREFIX_PATH="$installed" \
  -DCMAKE_BUILD_RPATH='$ORIGIN/lib' -DCMAKE_EXE_LINKER_FLAGS=-Wl,--disable-new-dtags \
  -DRUBRIC_FUZZ=ON \
  -DRUBRIC_FUZZ_ENGINE="$LIB_FUZZING_ENGINE" -DRUBRIC_TESTS=OFF
mapfile -t targets < <(cut -f1 "$build/fuzz_targets.tsv")
cmake --build "$build" --target "${targets[@]/%/_fuzz}"
python3 "$project/fuzz/oss-fuzz/package.py" "$build" "$OUT"
