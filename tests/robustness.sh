#!/bin/sh
# Measures what docs/robustness.md tells: the hard cases under every set of flags, mutants, lines that no test runs, fuzzing. Each
# is a script of its own; what they print is kept in build/robustness, then filled into the page.
set -u

usage="usage: tests/robustness.sh [--quick] [STEP...]

  STEP      flags, mutation, coverage, fuzz; all by default. Of the others the page has what their last run printed, which
            must be in build/robustness.
  --quick   one set of flags, a minute of fuzzing, and no page; kept in build/robustness/quick
  --help    this

Takes about an hour and a half on two cores, without flags and mutation half an hour."

quick=
steps=
for option; do
  case $option in
    --quick) quick=yes ;;
    --help) echo "$usage"; exit 0 ;;
    flags | mutation | coverage | fuzz) steps="$steps $option" ;;
    *) echo "tests/robustness.sh: unknown step '$option'; --help lists them" >&2; exit 2 ;;
  esac
done

cd "$(dirname "$0")/.." || exit 1
kept=build/robustness${quick:+/quick}
mkdir -p "$kept"
: "${steps:=flags mutation coverage fuzz}"
for step in flags mutation coverage fuzz; do
  case " $steps " in *" $step "*) continue ;; esac
  [ -n "$quick" ] || [ -f "$kept/$step.txt" ] || {
    echo "tests/robustness.sh: the page needs $step, too, of which $kept has no run" >&2
    exit 2
  }
done

# keep NAME COMMAND...: what it prints, also while it runs; only of what succeeds.
keep() {
  name=$1
  shift
  { "$@" </dev/null || echo "failed: $*"; } | tee "$kept/$name.new"
  ! grep -q '^failed: ' "$kept/$name.new" || return 1
  mv "$kept/$name.new" "$kept/$name.txt"
}

for step in $steps; do
  echo "== $step"
  case $step in
    flags) keep flags sh tests/hard_flags.sh ${quick:+--quick} || exit 1 ;;
    mutation) keep mutation sh tests/mutation.sh || exit 1 ;;
    coverage) keep coverage sh tests/coverage.sh || exit 1 ;;
    fuzz) keep fuzz sh tests/fuzz.sh "$([ -n "$quick" ] && echo 60 || echo 600)" || exit 1 ;;
  esac
done
[ -n "$quick" ] || sh docs/update.sh docs/robustness.md
