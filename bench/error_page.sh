#!/bin/sh
# error_page.sh FOLDER: docs/speed-vs-error.md on standard output, from what bench/report.sh has put into a folder.
set -eu

folder=$1
cd "$(dirname "$0")/.."
runs=$(awk -F, 'FNR > 1 && $NF > 0 && $(NF - 4) > most { most = $(NF - 4) } END { print most }' "$folder/error.csv")

# page WHAT [ALL]: a table of error.md.
page() { awk -v what="$1" -v all="${2-}" -f bench/error_page.awk "$folder/iterations.csv" "$folder/error.md"; }

cat <<TEXT
# Speed and error

How much error for how much time, made by \`sh bench/report.sh [--full]\`; it writes all of it, with 5000 and 50000 samples,
as \`error.csv\` and \`error.md\`. How long updates and optima take is in \`update.csv\`, \`optimum.csv\` and on [another page](speed.md).

The problems are those of the papers (T1–T3, L4, L5, V1–V4; L6 is V2), a mixture of bumps in the plane by four normal densities, and
a radial one in five dimensions by three. *Lobe* is made to ruin control variates: two densities on an interval that differ by 1 %, and
by a lobe of 1 % of one of them on a thousandth of the interval, that few samples meet. Their integrals, their V[F] and the fractions at which it is least come from
\`phimis/analysis\`, in two dimensions from a sum over a grid that converges exponentially.

- *Default*: \`integrate(f, techniques, {.budget = N})\`. *Joint*: \`joint_rule\`, with the combination that is named.
- *Oracle fractions*: fixed where V[F] is least. *Equal counts*, too, are one batch.
- *Optimal MIS*: the direct estimator of Kondapaneni et al. 2019, at equal counts.
- *Adam*: stochastic descent on the fraction after every other sample, two techniques, the one-sample model (Vorba et al. 2019).
  One-sample sampling costs the default little here: the line *default in one-sample sampling* far below.
- *Multichannel*: α ← α W^β in five iterations of the one-sample model, averaged by inverse variance (Kleiss & Pittau 1994); also by
  count, which is unbiased.
- *VEGAS*: that of GSL, in five iterations. It samples a box that it learns, not the techniques, and is stratified. In one smooth
  dimension that is another game, which only a mixture that fits exactly can win; in several it is given a box far wider than f and
  no warm-up, and has not found f yet.

N·MSE ± its standard error, in units of the oracle's, V[F] at its counts. On T2 and V3 an oracle has no variance, and the unit is V[F]
of equal counts; on V4 neither has, and N·MSE is as it is.

![RMSE against time](figures/speed_vs_error.svg)

## What was aimed at, at 500 samples

TEXT
page verdict
cat <<TEXT

The first column is free of the noise of runs: the mean, over runs, of the exact V[F] at the fractions that were learnt, each iteration in its
weight, with a standard error below .01. **At most 1.03 is missed** on all problems but the lobe: by less than 2 % on T1, V1, V2 and 5-D, most on L5. What
costs it is the first iteration at equal counts, and fractions from few samples; with 5000 samples the last table has less. Where the
oracle is exact the default is above it by orders of magnitude, for the same reason; with control variates it is exact, too, on T2.

Shrinkage is a choice between V2 and the lobe. V2's three pdfs are linearly dependent but for a part in ten thousand, and a third of the
mean squared error hangs on coefficients that the samples leave almost open; on the lobe, too, and there they are wrong: Optimal MIS,
which trusts them, has many times the mean squared error of equal counts. \`pooled_control_variates{shrinkage::off}\` trusts them; no other combination does.
On the lobe, as on V4, equal counts are as good as the best: there is nothing to learn.

Peers without fractions to learn win, too: Optimal MIS, which has control variates, wherever its column is below the default's, which has
none; and VEGAS in one dimension from 500 samples on, by orders of magnitude, but for T2, V3 and V4.
TEXT
printf '\n## N·MSE at 500 samples\n\n'
page 2
printf '\n## N·MSE at 50 samples\n\n'
page 1
printf '\n## Bias in standard errors, at 500 samples\n\nA number beyond ±4.5 means a bias. It depends on the runs: a bias that is a hundredth of a standard error of one run is 1 here in ten\nthousand runs; that of an estimate which is exact to rounding is the rounding of it.\n\n'
page 6
printf '\n## Time of a run of 500 samples, in μs\n\n'
page 8
cat <<TEXT

Equal counts take what sampling, evaluation and random numbers take; VEGAS draws its own points and evaluates no pdf.

## Other rules and combinations, N·MSE at 500 samples

TEXT
page 2 all | awk -F'|' 'NR < 3 || $2 ~ /rule|progressive|one-sample|fixed_weights|default, (inverse|pooled_|by_count)/'
cat <<TEXT

## How a budget is best spread over iterations

The default rule with iterations of other sizes and weights that look at no data: \`.growth\` is the samples of the last iteration over
those of the first. Mean, geometric, and worst N·MSE of the problems whose oracle has a variance, over its least V[F]; from the exact
V[F] of every iteration, with a standard error below .01 at 500 samples.

TEXT
cat "$folder/iterations.md"
cat <<TEXT

The default has 5 iterations with a growth of 16, by \`square_root\`. Five iterations of equal size by count pay for the first: a fifth of
the samples at equal counts. Where iterations grow, the first is a small part, and weights matter less; what is left is what fractions still
lack. In two dimensions that stays: χ², which the default minimises, and V[F] are least at other fractions.

## Measured on

TEXT
lscpu | sed -n 's/^Model name: */    /p'
g++ --version | sed -n 's/^/    /;1p'
cat <<TEXT
    -O3 -DNDEBUG -fno-math-errno

Seconds are processor time of one thread, the median of five groups of runs: another program on the machine costs less than in
elapsed time, but not nothing. Errors are those of fixed seeds, the same for every method, and do not depend on the machine's load or on
the number of threads. They are means over $runs runs of 50 and of 500 samples, a fifth of it for other rules and combinations.
TEXT
