# Every header of the library, by target. A new header gets its line here; the test `headers.listed` says which line
# is missing.

set(PHIMIS_CORE_HEADERS
    phimis/core.hpp
    phimis/core/config.hpp
    phimis/core/counts.hpp
    phimis/core/divergence.hpp
    phimis/core/estimator.hpp
    phimis/core/exact_minimiser.hpp
    phimis/core/finite.hpp
    phimis/core/fractions.hpp
    phimis/core/limits.hpp
    phimis/core/moments.hpp
    phimis/core/newton_raphson.hpp
    phimis/core/observation.hpp
    phimis/core/pack.hpp
    phimis/core/pair_sums.hpp
    phimis/core/rule.hpp
    phimis/core/solve_pair.hpp
    phimis/core/table.hpp
    phimis/core/uniform.hpp
    phimis/core/value.hpp
    phimis/core/version.hpp
    phimis/core/weight_heuristic.hpp)

set(PHIMIS_UPPER_HEADERS
    phimis/analysis/optimum.hpp
    phimis/analysis/problem.hpp
    phimis/analysis/variance.hpp
    phimis/concepts.hpp
    phimis/divergence/phi_divergence.hpp
    phimis/error.hpp
    phimis/estimator/batch.hpp
    phimis/estimator/combination.hpp
    phimis/integrate.hpp
    phimis/interval.hpp
    phimis/phimis.hpp
    phimis/quadrature/panels.hpp
    phimis/solver/rules.hpp
    phimis/solver/table.hpp
    phimis/technique/density.hpp
    phimis/technique/distribution.hpp
    phimis/technique/gaussian.hpp
    phimis/technique/technique_set.hpp
    phimis/validate.hpp)
