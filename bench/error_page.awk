# awk -f error_page.awk iterations.csv error.md: what a page shows of the tables that bench_error prints, a column for each
# problem; and beside them the default's expectations, of bench_iterations.

FILENAME ~ /iterations\.csv$/ {
  split($0, field, ",")
  if (field[2] == 500 && field[3] == 5 && field[4] == 16 && field[5] == "\"square_root\"") expected[field[1]] = field[6]
  next
}
/^### / { problem = $2; problems[++count] = problem; next }
/^\| method / || /^\|---/ { next }
/^\| / {
  split($0, cell, / *\| */)
  name = cell[2]
  if (!(name in seen)) { seen[name] = 1; methods[++lines] = name }
  for (i = 1; i <= 8; ++i) value[name, problem, i] = cell[2 + i]
}

function number(text) { split(text, part, " "); return part[1] + 0 }
function is_shown(name) { return name !~ /rule|progressive|one-sample|fixed_weights|default, (inverse|pooled_|by_count)/ }

function pivot(column, all,    i, p) {
  printf "| method |"
  for (p = 1; p <= count; ++p) printf " %s |", problems[p]
  printf "\n|---|"
  for (p = 1; p <= count; ++p) printf "---|"
  print ""
  for (i = 1; i <= lines; ++i) {
    if (!all && !is_shown(methods[i])) continue
    printf "| %s |", methods[i]
    for (p = 1; p <= count; ++p) {
      if ((methods[i], problems[p], column) in value) printf " %s |", value[methods[i], problems[p], column]
      else printf " – |"
    }
    print ""
  }
}

function verdict(column,    p, i, name, best, least, d, joint, cross, fitted, bare, kondapaneni, exact) {
  print "| problem | default / oracle, exact V[F] | at most 1.03 | default, N·MSE | default with cross-fitted control variates | best peer that adapts fractions | default below it | joint, cross-fitted | joint, pooled | joint, pooled, without shrinkage | Optimal MIS | it is above joint, pooled | and above joint, pooled, without shrinkage |"
  print "|---|---|---|---|---|---|---|---|---|---|---|---|---|"
  for (p = 1; p <= count; ++p) {
    best = ""
    for (i = 1; i <= lines; ++i) {
      name = methods[i]
      if (name !~ /^(Adam|multichannel)/ || !((name, problems[p], column) in value)) continue
      if (best == "" || number(value[name, problems[p], column]) < least) {
        best = name
        least = number(value[name, problems[p], column])
      }
    }
    d = value["default", problems[p], column]
    fitted = value["default, cross_fitted_control_variates", problems[p], column]
    cross = value["joint, cross_fitted_control_variates", problems[p], column]
    joint = value["joint, pooled_control_variates", problems[p], column]
    bare = value["joint, pooled_control_variates, no shrinkage", problems[p], column]
    kondapaneni = value["Optimal MIS, equal counts", problems[p], column]
    # Where the least V[F] vanishes, units are others: no ratio to the oracle.
    exact = problems[p] ~ /^(T2|V3|V4)$/
    printf "| %s | %s | %s | %s | %s | %s: %s | %s | %s | %s | %s | %s | %s | %s |\n", problems[p], \
      (exact ? "the oracle is exact" : expected[problems[p]]), (exact || expected[problems[p]] > 1.03 ? "no" : "yes"), d, fitted, \
      best, value[best, problems[p], column], (number(d) < least ? "yes" : "no"), cross, joint, bare, \
      kondapaneni, (number(joint) < number(kondapaneni) ? "yes" : "no"), (number(bare) < number(kondapaneni) ? "yes" : "no")
  }
}

END {
  if (what == "verdict") verdict(2)
  else pivot(what, all)
}
