#!/bin/sh
# Fills in what the documentation includes: code after `<!-- from: FILE -->`, what a program prints after
# `<!-- output: COMMAND -->`, each up to the line `<!-- end -->`. Programs come from the release preset.
set -eu

usage="usage: docs/update.sh [--check] [PAGE...]

  PAGE      all by default, but docs/robustness.md: tests/robustness.sh fills that in
  --check   changes nothing and runs no program: fails where included code differs from its file
  --help    this"

check=
pages=
for option; do
  case $option in
    --check) check=yes ;;
    --help) echo "$usage"; exit 0 ;;
    -*) echo "docs/update.sh: unknown option '$option'; --help lists them" >&2; exit 2 ;;
    *) pages="$pages $option" ;;
  esac
done
cd "$(dirname "$0")/.."
[ -n "$pages" ] || pages="README.md docs/policies.md docs/embedding.md docs/direct_lighting.md docs/environment_lighting.md docs/speed.md"

fill() {
  while IFS= read -r line; do
    printf '%s\n' "$line"
    case $line in
      '<!-- from: '*)
        file=${line#'<!-- from: '} file=${file%' -->'}
        skip_old=yes
        printf '```cpp\n'; grep -v '^// \(SPDX\|test:\)' "$file"; printf '```\n' ;;
      '<!-- output: '*)
        if [ -n "$check" ]; then
          skip_old=
        else
          command=${line#'<!-- output: '} command=${command%' -->'}
          skip_old=yes
          sh -c "$command" || { echo "docs/update.sh: $1: failed: $command" >&2; return 1; }
        fi ;;
      *) skip_old= ;;
    esac
    [ -z "$skip_old" ] || while IFS= read -r line && [ "$line" != '<!-- end -->' ]; do :; done
    [ -z "$skip_old" ] || printf '%s\n' '<!-- end -->'
  done <"$1"
}

status=0
for page in $pages; do
  filled=$(mktemp)
  fill "$page" >"$filled" || { rm -f "$filled"; exit 1; }
  if cmp -s "$filled" "$page"; then
    rm -f "$filled"
  elif [ -n "$check" ]; then
    echo "docs/update.sh: $page differs from what it includes; run docs/update.sh" >&2
    diff "$page" "$filled" >&2 || true
    rm -f "$filled"
    status=1
  else
    cat "$filled" >"$page"
    rm -f "$filled"
    echo "updated $page"
  fi
done
exit $status
