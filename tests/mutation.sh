#!/bin/sh
# Would a wrong formula be noticed? Breaks the formulas of tests/mutants.txt one at a time, in a copy of their header, and
# runs the tests that must fail then. The last line counts them.
set -u

usage="usage: tests/mutation.sh [--list] [--jobs N] [FILTER]

  FILTER     only mutants whose identifier, header and tests match this regular expression
  --list     changes and runs nothing: lists mutants with their header and tests
  --jobs N   so many at a time; CMAKE_BUILD_PARALLEL_LEVEL by default, or one for each core
  --help     this

Fails where a mutant survives its tests, does not compile, or its text is not in its header exactly once; and where one of
the tests fails by itself. The compiler is \$CXX, g++ by default."

filter=
list=
jobs=${CMAKE_BUILD_PARALLEL_LEVEL:-$(getconf _NPROCESSORS_ONLN)}
while [ $# -gt 0 ]; do
  case $1 in
    --list) list=yes ;;
    --jobs) shift; jobs=${1-} ;;
    --help) echo "$usage"; exit 0 ;;
    -*) echo "tests/mutation.sh: unknown option '$1'; --help lists them" >&2; exit 2 ;;
    *) [ -z "$filter" ] || { echo "tests/mutation.sh: one FILTER, not '$filter' and '$1'" >&2; exit 2; }
       filter=$1 ;;
  esac
  shift
done
case $jobs in '' | *[!0-9]* | 0) echo "tests/mutation.sh: --jobs takes a number from 1" >&2; exit 2 ;; esac

cd "$(dirname "$0")/.." || exit 1
mutants=tests/mutants.txt
# A line for each: identifier, header, tests.
lines=$(awk -v filter="$filter" '
  /^[a-z]/ && (filter == "" || $0 ~ filter) {
    if (NF < 3) { print "tests/mutants.txt:" NR ": an identifier, a header and its tests are needed" >"/dev/stderr"; exit 1 }
    if (seen[$1]++) { print "tests/mutants.txt:" NR ": " $1 " is there twice" >"/dev/stderr"; exit 1 }
    print
  }' "$mutants") || exit 1
[ -n "$lines" ] || { echo "tests/mutation.sh: no mutant matches '$filter'" >&2; exit 1; }
if [ -n "$list" ]; then
  echo "$lines"
  exit 0
fi

work=build/mutation
rm -rf "$work"
mkdir -p "$work/17" "$work/20" "$work/results" || exit 1
compiler=${CXX:-g++}

# compile 17 -c FILE...: what all compilations share.
compile() {
  compile_standard=$1
  shift
  # shellcheck disable=SC2086  # the compiler may come with options
  $compiler -std=c++"$compile_standard" -O0 -w -pthread -I "$work/$compile_standard" "$@"
}

# Catch2 is read once for each standard, not for each mutant; 3.x brings its main.
for standard in 17 20; do
  case $compiler in
    *clang*) ;;
    *) compile $standard -x c++-header tests/catch.hpp -o "$work/$standard/catch.hpp.gch" || exit 1 ;;
  esac
done
if echo '#include <catch2/catch_test_macros.hpp>' | compile 17 -x c++ -fsyntax-only - 2>/dev/null; then
  main="-lCatch2Main -lCatch2"
else
  compile 17 -c tests/catch_main.cpp -o "$work/main.o" || exit 1
  main=$work/main.o
fi

# try INCLUDES TEST FOLDER: 0 where the test passes, 1 where it fails, 2 where it does not compile.
try() {
  try_standard=20
  case $2 in unit/core/*) try_standard=17 ;; esac
  # shellcheck disable=SC2086  # libraries
  if ! compile $try_standard -I "$1" -I include -I tests -I examples -isystem /usr/include/eigen3 -isystem \
    /usr/local/include/eigen3 "tests/$2.cpp" $main -o "$3/test" >"$3/log" 2>&1; then
    # What a static_assert catches is caught.
    grep -q 'static assertion failed\|static_assert failed' "$3/log" && return 1
    return 2
  fi
  # A mutant may never end.
  timeout 120 "$3/test" >"$3/log" 2>&1 </dev/null && try_result=0 || try_result=1
  rm -f "$3/test"
  return "$try_result"
}

# put IDENTIFIER HEADER TO: the header with that mutant.
put() {
  awk -v id="$1" '
    function complain(what) { print what >"/dev/stderr"; bad = 1; exit 1 }
    FNR == NR {
      if (/^[a-z]/) ours = $1 == id
      if (ours && /^- /) from[++pairs] = substr($0, 3)
      if (ours && /^\+ /) to[pairs] = substr($0, 3)
      next
    }
    {
      for (i = 1; i <= pairs; ++i) {
        at = index($0, from[i])
        if (!at) continue
        rest = substr($0, at + length(from[i]))
        if (++found[i] > 1 || index(rest, from[i])) complain("more than once: " from[i])
        $0 = substr($0, 1, at - 1) to[i] rest
      }
      print
    }
    END {
      if (bad) exit 1
      if (!pairs) complain("nothing to change")
      for (i = 1; i <= pairs; ++i) if (!found[i]) complain("not there: " from[i])
    }' "$mutants" "include/phimis/$2" >"$3"
}

# one KIND NAME HEADER TESTS...: a line in results/.
one() {
  kind=$1 name=$2 header=$3
  shift 3
  begin=$(date +%s)
  folder=$work/$(echo "$name" | tr / _)
  mkdir -p "$folder"
  if [ "$kind" = test ]; then
    try include "$name" "$folder" && verdict=passes || verdict="FAILS by itself: $folder/log"
  else
    mkdir -p "$folder/include/phimis/$(dirname "$header")"
    if ! put "$name" "$header" "$folder/include/phimis/$header" 2>"$folder/log"; then
      verdict="STALE: $header: $(cat "$folder/log")"
    else
      verdict="SURVIVED $*"
      for test; do
        try "$folder/include" "$test" "$folder"
        case $? in
          0) continue ;;
          1) verdict="caught by $test" ;;
          *) verdict="DOES NOT COMPILE: $folder/log" ;;
        esac
        break
      done
    fi
  fi
  line="$kind $name: $verdict, $(($(date +%s) - begin)) s"
  echo "$line"
  echo "$line" >"$work/results/$(basename "$folder")"
}

# A part of the lines on standard input, of the kind given: each job takes every so many.
all_of() {
  awk '{ print }' >"$work/todo"
  job=0
  while [ "$job" -lt "$jobs" ]; do
    awk -v job="$job" -v jobs="$jobs" 'NR % jobs == job' "$work/todo" >"$work/todo.$job"
    # shellcheck disable=SC2086  # words of a line
    while read -r todo; do one "$1" $todo; done <"$work/todo.$job" &
    job=$((job + 1))
  done
  wait
}

begin=$(date +%s)
echo "$lines" | awk '{ for (i = 3; i <= NF; ++i) if (!seen[$i]++) print $i, "-" }' | all_of test
echo "$lines" | all_of mutant

count() { cat "$work"/results/* | grep -c "$1"; }
total=$(echo "$lines" | wc -l)
caught=$(count '^mutant .*: caught')
passing=$(count '^test .*: passes')
tests=$(count '^test')
cat "$work"/results/* | grep 'SURVIVED\|STALE\|DOES NOT COMPILE\|FAILS'
echo "mutation: $caught of $total mutants caught, $passing of $tests tests pass without them, $(($(date +%s) - begin)) s"
[ "$caught" -eq "$total" ] && [ "$passing" -eq "$tests" ]
