#!/usr/bin/env bash
# ClusterFuzzLite builds what OSS-Fuzz builds.
exec bash -eu "$SRC/rubric/fuzz/oss-fuzz/build.sh"
