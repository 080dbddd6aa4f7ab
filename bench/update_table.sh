#!/bin/sh
# The benchmark of updates as Markdown tables of two techniques, then of more; or with --csv as
# rule,gamma,real,m,n,ns_per_observation,limit_ratio. Needs the release preset; options after that are the benchmark's.
set -eu
cd "$(dirname "$0")/.."
form=table
[ "${1-}" != --csv ] || { form=csv; shift; }
build/release/bench/bench_update --benchmark_format=csv "$@" 2>/dev/null | awk -F, -v form="$form" '
  $1 == "name" { for (i = 1; i <= NF; ++i) { gsub(/"/, "", $i); column[$i] = i } next }
  NF > 5 {
    gsub(/"/, "", $1); split($1, part, "/")
    rule = part[1]; gamma = part[2]; real = part[3]; m = part[4]; n = part[5]
    time = $column["ns_per_row"]; times = $column["ratio"]
    if (form == "csv") {
      if (!lines++) print "rule,gamma,real,m,n,ns_per_observation,limit_ratio"
      printf "%s,%s,%s,%s,%s,%.4g,%.4g\n", rule, gamma, real, m, n, time, times
      next
    }
    ns[rule, gamma, real, m, n] = time
    ratio[rule, gamma, real, m, n] = times
    evaluations[rule, gamma, real, m, n] = $column["evaluations"]
    if (rule == "evaluation") order[++count] = gamma "/" real "/" m "/" n
    if (gamma == "-" && !((real, m, n) in seen)) { seen[real, m, n] = 1; plain[++plains] = real "/" m "/" n }
  }
  function cell(rule, gamma) { return (rule, gamma, real, m, n) in ns ? sprintf("%.1f", ns[rule, gamma, real, m, n]) : "–" }
  END {
    if (form == "csv") exit
    print "| m | real | γ | n | one evaluation, ns | ratio to the limit | exact update, ns | ratio | evaluations | streaming Newton, ns | Newton–Raphson, ns |"
    print "|---|---|---|---|---|---|---|---|---|---|---|"
    for (i = 1; i <= count; ++i) {
      split(order[i], part, "/"); gamma = part[1]; real = part[2]; m = part[3]; n = part[4]
      if (n == 10000 || n == 100000) continue
      printf "| %d | %s | %s | %d | %.2f | %.2f | %s | %.1f | %d | %s | %s |\n", m, real, gamma, n,
        ns["evaluation", gamma, real, m, n], ratio["evaluation", gamma, real, m, n], cell("exact", gamma),
        ratio["exact", gamma, real, m, n], evaluations["exact", gamma, real, m, n], cell("streaming_newton", gamma),
        cell("newton_raphson", gamma)
    }
    print ""
    print "| m | real | n | linear heuristic, ns | second order, ns | σ-proportional, ns | inverse variance, ns |"
    print "|---|---|---|---|---|---|---|"
    for (i = 1; i <= plains; ++i) {
      split(plain[i], part, "/"); real = part[1]; m = part[2]; n = part[3]
      if (n != 100 && n != 10000) continue
      printf "| %d | %s | %d | %s | %s | %s | %s |\n", m, real, n, cell("linear_heuristic", "-"), cell("second_order", "-"),
        cell("sigma_proportional", "-"), cell("inverse_variance", "-")
    }
  }'
