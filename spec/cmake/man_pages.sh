#!/usr/bin/env bash
# man_pages.sh HELP2MAN RUBRIC RUBRICC RUBRIC_EXTCAP FOLDER: a manual page of each program and each
# command of rubric, from what they say of themselves.
set -euo pipefail
help2man=$1 rubric=$2 rubricc=$3 extcap=$4 folder=$5
rm -rf "$folder"
mkdir -p "$folder"
version=$("$rubric" --version)

about=$(mktemp)
trap 'rm -f "$about"' EXIT
cat > "$about" <<'END'
[files]
.TP
.I share/doc/rubric/rubric.html
The book, beside share/man, if it was built before the installation (target "book", see README.md
there).
END

page() {  # page NAME WHAT COMMAND
  "$help2man" --no-info --no-discard-stderr --version-string="$version" --name="$2" \
    --include="$about" \
    --output="$folder/$1.1" "$3"
  sed -i "1,/^\.TH/s/^\.TH .*/.TH ${1^^} 1 \"\" \"rubric $version\" \"User Commands\"/" "$folder/$1.1"
}
"$rubric" --help | sed -n '/^Subcommands:/,/^$/p' | sed -n 's/^  \([a-z][a-z-]*\)  *\(.*\)/\1\t\2/p' |
  while IFS=$'\t' read -r command what; do
    page "rubric-$command" "$what" "$rubric $command"
  done
page rubric "codec and conformance test kit for the RUBICON Communication Layer" "$rubric"
page rubricc "compiler of wire specs" "$rubricc"
page rubric-extcap "captures for Wireshark from motes and serial forwarders" "$extcap"
gzip -9n "$folder"/*.1
