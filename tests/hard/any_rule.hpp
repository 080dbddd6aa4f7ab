// SPDX-License-Identifier: MIT
#ifndef PHIMIS_TESTS_HARD_ANY_RULE_HPP
#define PHIMIS_TESTS_HARD_ANY_RULE_HPP

#include <phimis/analysis/optimum.hpp>
#include <phimis/core/rule.hpp>

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

// Every rule and every divergence without its type: a hard case is a loop over one of the lists below, which every_rule.cpp
// has.

namespace hard {

/// A divergence that is known by its name: what it is like, and the oracle's fractions for it.
struct any_divergence {
  std::string name;
  bool infinite_at_zero;  ///< where f = 0 < p
  bool power;             ///< s = t^β, −t^β or log t
  double exponent;        ///< β
  bool steps;             ///< s jumps: a condition changes sign in place of having a root
  bool variance;          ///< V[F]: looks at the sign of f, is not convex
  std::function<phimis::analysis::optimal_fractions<2>(const phimis::analysis::problem<2>&,
                                                       const phimis::rule_options<double, 2>&)>
      optimum;
};

/// The built-in divergences that have a score, forward and reversed.
const std::vector<any_divergence>& every_divergence();
/// V[F], which has none.
const any_divergence& multi_sample_variance();

/// How a rule comes to its fractions.
enum class way {
  at_once,   ///< to the minimum of its divergence on all observations
  by_steps,  ///< towards it, one update after the other, each with a batch of its own
  otherwise  ///< by something else
};

/// A rule with its name, as a value; itself a model of phimis::rule.
template <class Real, int M>
class any_rule {
 public:
  static constexpr int techniques = M;
  using real = Real;
  using observation = phimis::observation<Real, M>;

  template <class Rule>
  any_rule(std::string name, way how, const any_divergence* divergence, Rule rule)
      : name_(std::move(name)), how_(how), divergence_(divergence), rule_(std::make_unique<model<Rule>>(rule)) {}
  any_rule(const any_rule& other)
      : name_(other.name_), how_(other.how_), divergence_(other.divergence_), rule_(other.rule_->copy()) {}
  any_rule& operator=(const any_rule& other) { return *this = any_rule(other); }
  any_rule(any_rule&&) noexcept = default;
  any_rule& operator=(any_rule&&) noexcept = default;

  const std::string& name() const { return name_; }
  way how() const { return how_; }
  /// What it minimises, or nothing.
  const any_divergence* divergence() const { return divergence_; }
  bool infinite_at_zero() const { return divergence_ && divergence_->infinite_at_zero; }

  void observe(const observation& sample) { rule_->observe(sample); }
  phimis::rule_status update() { return rule_->update(); }
  phimis::fractions<Real, M> fractions() const { return rule_->fractions(); }
  phimis::rule_status status() const { return rule_->status(); }
  const phimis::rule_counters<Real>& counters() const { return rule_->counters(); }
  const phimis::rule_options<Real, M>& options() const { return rule_->options(); }
  /// Requires a rule of the same type.
  void merge(const any_rule& other) { rule_->merge(*other.rule_); }

 private:
  struct base {
    virtual ~base() = default;
    virtual std::unique_ptr<base> copy() const = 0;
    virtual void observe(const observation&) = 0;
    virtual phimis::rule_status update() = 0;
    virtual phimis::fractions<Real, M> fractions() const = 0;
    virtual phimis::rule_status status() const = 0;
    virtual const phimis::rule_counters<Real>& counters() const = 0;
    virtual const phimis::rule_options<Real, M>& options() const = 0;
    virtual void merge(const base&) = 0;
  };
  template <class Rule>
  struct model : base {
    explicit model(const Rule& given) : rule(given) {}
    std::unique_ptr<base> copy() const override { return std::make_unique<model>(rule); }
    void observe(const observation& sample) override { rule.observe(sample); }
    phimis::rule_status update() override { return rule.update(); }
    phimis::fractions<Real, M> fractions() const override { return rule.fractions(); }
    phimis::rule_status status() const override { return rule.status(); }
    const phimis::rule_counters<Real>& counters() const override { return rule.counters(); }
    const phimis::rule_options<Real, M>& options() const override { return rule.options(); }
    void merge(const base& other) override { rule.merge(dynamic_cast<const model&>(other).rule); }
    Rule rule;
  };

  std::string name_;
  way how_;
  const any_divergence* divergence_;
  std::unique_ptr<base> rule_;
};

/// The exact minimiser of every divergence, in the order of `every_divergence`, and of V[F] at the end.
///
/// Shapes float and double, 2 and 3 techniques; of `every_rule` too.
template <class Real, int M>
std::vector<any_rule<Real, M>> exact_rules(const phimis::rule_options<Real, M>& options = {},
                                           phimis::control_variate variate = phimis::control_variate::on);

/// Every rule that there is, with every divergence that it takes. The joint rule has no float.
template <class Real, int M>
std::vector<any_rule<Real, M>> every_rule(const phimis::rule_options<Real, M>& options = {},
                                          phimis::control_variate variate = phimis::control_variate::on);

}  // namespace hard

#endif  // PHIMIS_TESTS_HARD_ANY_RULE_HPP
