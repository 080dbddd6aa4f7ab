// SPDX-License-Identifier: MIT
#ifndef PHIMIS_PHIMIS_HPP
#define PHIMIS_PHIMIS_HPP

// All that a program needs to integrate. The oracle, <phimis/analysis/...>, and custom divergences,
// <phimis/divergence/phi_divergence.hpp>, are included apart: they cost more to compile.
#include <phimis/concepts.hpp>
#include <phimis/core.hpp>
#include <phimis/error.hpp>
#include <phimis/estimator/batch.hpp>
#include <phimis/estimator/combination.hpp>
#include <phimis/integrate.hpp>
#include <phimis/interval.hpp>
#include <phimis/solver/rules.hpp>
#include <phimis/solver/table.hpp>
#include <phimis/technique/density.hpp>
#include <phimis/technique/distribution.hpp>
#include <phimis/technique/gaussian.hpp>
#include <phimis/technique/technique_set.hpp>
#include <phimis/validate.hpp>

#endif  // PHIMIS_PHIMIS_HPP
