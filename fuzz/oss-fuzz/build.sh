#!/usr/bin/env bash
# Builds every fuzz target into $OUT, with the compiler, flags and engine that the environment
# names: as OSS-Fuzz and ClusterFuzzLite call it, for libFuzzer, AFL++ and honggfuzz.
# $SRC/rubric is this project; its libraries are the system's.
set -euo pipefail

project=$SRC/rubric
build=$WORK/rubric
export CMAKE_BUILD_PARALLEL_LEVEL=${CMAKE_BUILD_PARALLEL_LEVEL:-$(nproc)}

# The system's libraries were built with the system's C++ library, so the targets take that, too.
# fmt 9 checks formats at compile time in a way that newer clangs do not take.
export CXXFLAGS="${CXXFLAGS//-stdlib=libc++/} -DFMT_CONSTEVAL="

# Libraries that a runner may lack are copied beside the targets, which look for them there.
cmake -S "$project" -B "$build" -G Ninja \
  -DCMAKE_BUILD_RPATH='$ORIGIN/lib' -DCMAKE_EXE_LINKER_FLAGS=-Wl,--disable-new-dtags \
  -DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=0 \
  -DRUBRIC_FUZZ=ON -DRUBRIC_FUZZ_ENGINE="$LIB_FUZZING_ENGINE" -DRUBRIC_TESTS=OFF
mapfile -t targets < <(cut -f1 "$build/fuzz_targets.tsv")
cmake --build "$build" --target "${targets[@]/%/_fuzz}"
python3 "$project/fuzz/oss-fuzz/package.py" "$build" "$OUT"
