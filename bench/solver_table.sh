#!/bin/sh
# The benchmark of solvers: Markdown tables on standard output, docs/figures/speed_solver.csv and the figure of it. Needs
# the release preset and gnuplot; takes ten minutes, since peers are given five seconds each.
set -eu
cd "$(dirname "$0")/.."
figure=docs/figures/speed_solver
build/release/bench/bench_solver --csv "$figure.csv"
gnuplot -e "data = '$figure.csv'; picture = '$figure.svg'" bench/solver_figure.gp >&2
