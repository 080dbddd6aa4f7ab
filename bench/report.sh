#!/bin/sh
# How much time do updates and optima take, and how much error is there for how much time? Builds the benchmarks, runs them,
# and writes docs/speed-vs-error.md.
set -eu

usage="usage: bench/report.sh [--quick|--full] [FOLDER]

  FOLDER    where update.csv, optimum.csv, error.csv and all tables go; build/report by default
  --quick   few runs, within two minutes: a check that everything runs; leaves docs/ as it is
  --full    four times the runs, ten seconds for each optimum of a peer; without either, within a quarter of an hour
  --help    this"

effort=
folder=
for option; do
  case $option in
    --quick | --full) effort=$option ;;
    --help) echo "$usage"; exit 0 ;;
    -*) echo "bench/report.sh: unknown option '$option'; --help lists them" >&2; exit 2 ;;
    *) [ -z "$folder" ] || { echo "bench/report.sh: one FOLDER, not '$folder' and '$option'" >&2; exit 2; }
       folder=$option ;;
  esac
done

here=$(pwd)
cd "$(dirname "$0")/.."
case ${folder:=$PWD/build/report} in
  /*) ;;
  *) folder=$here/$folder ;;
esac
case $effort in
  --quick) error="--runs 400 --most 5000" iterations="--runs 20" update="--benchmark_min_time=0.01 --benchmark_filter=/(10|100|1000)$"
           solver="--limit 0.1 --rows 1000" ;;
  --full) error="--runs 40000" iterations="--runs 1000" update=--benchmark_min_time=0.2 solver="--limit 10 --rows 100000" ;;
  *) error="--runs 10000" iterations="--runs 300" update=--benchmark_min_time=0.05 solver="--limit 0.5 --rows 10000" ;;
esac

programs="bench_update bench_solver bench_error bench_iterations"
cmake --preset release </dev/null >/dev/null
# shellcheck disable=SC2086  # a list of targets
cmake --build build/release --target $programs </dev/null
mkdir -p "$folder"
built=build/release/bench

echo "updates"
# shellcheck disable=SC2086  # options
$built/bench_update --benchmark_format=csv $update 2>/dev/null |
  awk -F, '
    BEGIN { print "rule,gamma,real,m,n,ns_per_observation,limit_ratio" }
    $1 == "name" { for (i = 1; i <= NF; ++i) { gsub(/"/, "", $i); column[$i] = i } next }
    NF > 5 {
      gsub(/"/, "", $1); split($1, part, "/"); sub("gamma:", "", part[3])
      of = part[2] "/" part[3] "/" part[4]
      ns = $column["ns_per_row"]
      # An evaluation is timed in turns with the limit, which then serves the updates of the same rows.
      if (part[1] == "one_evaluation") limit[of] = ns / $column["ratio"]
      printf "%s,%s,%s,2,%s,%.4g,%.4g\n", part[1], part[3], part[2], part[4], ns, ns / limit[of]
    }' >"$folder/update.csv"

echo "optima"
# shellcheck disable=SC2086
$built/bench_solver --csv "$folder/solver.csv" $solver >"$folder/optimum.md"
awk -F, '
  BEGIN { print "method,gamma,m,n,kkt,seconds,ratio_to_ours" }
  FNR == 1 { next }
  $4 == "phimis" { ours[$1, $2, $3] = $5 }
  { printf "%s,%s,%s,%s,%s,%s,%.4g\n", $4, $1, $3, $2, $6, $5, $5 / ours[$1, $2, $3] }' \
  "$folder/solver.csv" >"$folder/optimum.csv"

echo "iterations"
# shellcheck disable=SC2086
$built/bench_iterations --csv "$folder/iterations.csv" $iterations >"$folder/iterations.md"

echo "errors"
# shellcheck disable=SC2086
$built/bench_error --csv "$folder/error.csv" $error >"$folder/error.md"
gnuplot -e "data = '$folder/error.csv'; picture = '$folder/speed_vs_error.svg'" bench/error_figure.gp

# page WHAT [ALL]: a table of error.md.
page() { awk -v what="$1" -v all="${2-}" -f bench/error_page.awk "$folder/error.md"; }

{
  cat <<TEXT
# Speed and error

How much error for how much time, made by \`sh bench/report.sh${effort:+ $effort}\`; it writes all of it, with 5000 and 50000 samples,
as \`error.csv\` and \`error.md\`. How long updates and optima take is in \`update.csv\`, \`optimum.csv\` and on [another page](speed.md).

The problems are those of the papers (T1–T3, L4, L5, V1–V4; L6 is V2), a mixture of bumps in the plane by four normal densities, and
a radial one in five dimensions by three. Their integrals, their V[F] and the fractions at which it is least come from
\`phimis/analysis\`, in two dimensions from a sum over a grid that converges exponentially.

- *Default*: \`integrate(f, techniques, {.budget = N})\`. *Joint*: \`joint_rule\`, with the combination that is named.
- *Oracle fractions*: fixed where V[F] is least. *Equal counts*, too, are one batch.
- *Optimal MIS*: the direct estimator of Kondapaneni et al. 2019, at equal counts.
- *Adam*: stochastic descent on the fraction after every other sample, two techniques, the one-sample model (Vorba et al. 2019).
- *Multichannel*: α ← α W^β in five iterations of the one-sample model, averaged by inverse variance (Kleiss & Pittau 1994); also by
  count, which is unbiased.
- *VEGAS*: that of GSL, in five iterations. It samples a box that it learns, not the techniques, and is stratified. In one smooth
  dimension that is another game, which no mixture of given techniques can win.

N·MSE ± its standard error, in units of the oracle's, V[F] at its counts. On T2 and V3 an oracle has no variance, and the unit is V[F]
of equal counts; on V4 neither has, and N·MSE is as it is.

![RMSE against time](figures/speed_vs_error.svg)

## What was aimed at, at 500 samples

TEXT
  page verdict
  printf '\n## N·MSE at 500 samples\n\n'
  page 2
  printf '\n## N·MSE at 50 samples\n\n'
  page 1
  printf '\n## Bias in standard errors, at 500 samples\n\nBeyond ±4.5 it is one. It depends on the runs: a bias that is a hundredth of a standard error of one run is 1 here in ten thousand.\n\n'
  page 6
  printf '\n## Time of a run of 500 samples, in μs\n\n'
  page 8
  cat <<TEXT

Most of it is sampling, evaluation and random numbers, the same for all.

## Other rules and combinations, N·MSE at 500 samples

TEXT
  page 2 all | awk -F'|' 'NR < 3 || $2 ~ /rule|progressive|one-sample|fixed_weights|default, (inverse|cross|pooled_)|joint, growth/'
  cat <<TEXT

## How a budget is best spread over iterations

The default rule with iterations of other sizes and weights that look at no data: \`.growth\` is the samples of the last iteration over
those of the first. Mean, geometric, and worst N·MSE of the problems whose oracle has a variance, over its least V[F]; from the exact
V[F] of every iteration, with a standard error below .01 at 500 samples.

TEXT
  cat "$folder/iterations.md"
  cat <<TEXT

The default, 5 iterations of equal size by count, pays for its first: a fifth of the samples at equal counts. What fractions still lack
in later iterations is little. Where iterations grow, the first is a small part, and weights matter less.

## Measured on

TEXT
  lscpu | sed -n 's/^Model name: */    /p'
  g++ --version | sed -n 's/^/    /;1p'
  cat <<TEXT
    -O3 -DNDEBUG -fno-math-errno

Seconds are processor time of one thread, the median of five groups of runs: another program on the machine costs less than in
elapsed time, but not nothing. Errors are those of fixed seeds, the same for every method, and do not depend on the machine's load or on
the number of threads. They are means over runs, 10000 for 50 and for 500 samples without an option (\`runs\` in \`error.csv\`), a fifth
of it for other rules and combinations.
TEXT
} >"$folder/speed-vs-error.md"
if [ "$effort" != --quick ]; then
  cp "$folder/speed-vs-error.md" docs/speed-vs-error.md
  cp "$folder/speed_vs_error.svg" docs/figures/speed_vs_error.svg
fi
echo "reported into $folder"
