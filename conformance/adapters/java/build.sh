#!/bin/sh
# Compiles the Java base station; with further folders, their sources too.
# usage: build.sh JAVAC SOURCES CLASSES [FOLDER...]
# SOURCES is this folder or a copy of it; CLASSES is emptied first.
set -eu
javac=$1
sources=$2
classes=$3
shift 3
rm -rf "$classes"
mkdir -p "$classes"
find "$sources/wire" "$sources/generated" "$sources/src" "$@" -name '*.java' >"$classes/sources"
"$javac" --release 17 -encoding UTF-8 -Xlint:all -Werror -d "$classes" "@$classes/sources"
rm "$classes/sources"
