// SPDX-License-Identifier: MIT
#ifndef PHIMIS_BENCH_ANY_TECHNIQUE_HPP
#define PHIMIS_BENCH_ANY_TECHNIQUE_HPP

#include <phimis/concepts.hpp>
#include <phimis/technique/technique_set.hpp>

#include <array>
#include <cstddef>
#include <memory>
#include <type_traits>
#include <utility>

namespace bench {

/// A point of any problem: as many coordinates as it has, the rest 0.
using point = std::array<double, 5>;

/// Uniform numbers of any kind, by reference.
struct any_uniform {
  void* source;
  double (*draw)(void*);
  double operator()() const { return draw(source); }
};

/// A technique of any kind, so that every method is compiled once for each number of techniques, not for each problem.
class any_technique {
  struct model {
    virtual ~model() = default;
    virtual point sample(any_uniform next) const = 0;
    virtual double pdf(const point& x) const = 0;
  };
  template <class Technique>
  struct model_of final : model {
    explicit model_of(Technique t) : technique(std::move(t)) {}
    point sample(any_uniform next) const override {
      if constexpr (one_dimension) {
        return {technique.sample(next)};
      } else {
        return technique.sample(next);
      }
    }
    double pdf(const point& x) const override {
      if constexpr (one_dimension) {
        return technique.pdf(x[0]);
      } else {
        return technique.pdf(x);
      }
    }
    static constexpr bool one_dimension = requires(const Technique& t) { t.pdf(0.5); };
    Technique technique;
  };

 public:
  template <class Technique>
  explicit any_technique(Technique technique)
      : model_(std::make_shared<const model_of<Technique>>(std::move(technique))) {}

  template <phimis::uniform_source Next>
  point sample(Next&& next) const {
    using source_type = std::remove_reference_t<Next>;
    return model_->sample({&next, [](void* source) { return (*static_cast<source_type*>(source))(); }});
  }
  double pdf(const point& x) const { return model_->pdf(x); }

 private:
  std::shared_ptr<const model> model_;
};

namespace detail {
template <std::size_t... I>
phimis::technique_set<decltype((void)I, any_technique(std::declval<any_technique>()))...> set_of(
    std::index_sequence<I...>);
}  // namespace detail

/// M techniques of any kind.
template <int M>
using any_techniques = decltype(detail::set_of(std::make_index_sequence<M>{}));

}  // namespace bench

#endif  // PHIMIS_BENCH_ANY_TECHNIQUE_HPP
