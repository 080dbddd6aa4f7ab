// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_CASES_HPP
#define PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_CASES_HPP

#include <environment_lighting/environment_map.hpp>
#include <environment_lighting/map_file.hpp>
#include <environment_lighting/mesh.hpp>
#include <environment_lighting/mesh_file.hpp>
#include <environment_lighting/scene.hpp>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace environment_lighting {

/// What is lit by what. All else is the same in every case.
struct test_case {
  std::string name;
  std::string map;       ///< file
  std::string object;    ///< sphere, knot, or a file
  std::string material;  ///< lambert, varying, or glossy:N with the exponent N
};

/// Ten cases, as V has: eight maps, two objects, several BRDFs, one of them varying over the surface. V prints neither.
inline std::vector<test_case> ten_cases(const std::filesystem::path& maps) {
  std::vector<test_case> cases{{"", "city", "sphere", "lambert"},     {"", "courtyard", "sphere", "glossy:1000"},
                               {"", "forest", "sphere", "glossy:50"}, {"", "interior", "sphere", "varying"},
                               {"", "night", "sphere", "glossy:10"},  {"", "studio", "knot", "glossy:30"},
                               {"", "sunrise", "knot", "glossy:10"},  {"", "sunset", "knot", "varying"},
                               {"", "forest", "knot", "glossy:100"},  {"", "interior", "knot", "lambert"}};
  int number = 0;
  for (test_case& one : cases) {
    one.name = std::to_string(++number) + ' ' + one.map + ", " + one.object + ", " + one.material;
    one.map = (maps / (one.map + ".exr")).string();
  }
  return cases;
}

/// The material of each point of the unit object.   Errors std::invalid_argument.
inline std::function<material(const vector&)> make_material(const std::string& name) {
  if (name == "lambert") return [](const vector&) { return material{}; };
  if (name == "varying") {
    return [](const vector& x) {
      const float around = std::atan2(x.z(), x.x());
      return material{.diffuse = 0.4f,
                      .exponent = std::pow(10.0f, 1.7f + 0.7f * std::sin(5 * around) * std::sin(6 * x.y()))};
    };
  }
  float exponent = 0;
  char more = 0;
  if (std::sscanf(name.c_str(), "glossy:%f%c", &exponent, &more) == 1 && exponent >= 0 && exponent <= 1e6f) {
    return [exponent](const vector&) { return material{.diffuse = 0.4f, .exponent = exponent}; };
  }
  throw std::invalid_argument("--material " + name + ": not lambert, varying, or glossy:N with N from 0 to 1e6");
}

/// A case that can be rendered. What was noticed about its files is printed, a line each.
///
/// Errors papers::cannot_run where a file cannot be used; std::invalid_argument for a material that there is not.
class lit_scene {
 public:
  lit_scene(const test_case& of, int width, int height, int threads)
      : light_(map_of(of)),
        scene_(object_of(of), cage(1.3f, 6, 0.1f), light_, make_material(of.material)),
        points_(shading_points(scene_, width, height, threads)) {}
  lit_scene(const lit_scene&) = delete;

  const scene& world() const { return scene_; }
  const render::image<shading_point>& points() const { return points_; }

 private:
  static environment_map map_of(const test_case& of) {
    if (of.map == analytic_sky_name) return environment_map(analytic_sky());
    read_map map = read_map_file(of.map);
    say(map.remark);
    return environment_map(std::move(map.radiance));
  }
  static mesh object_of(const test_case& of) {
    if (of.object == "sphere") return sphere();
    if (of.object == "knot") return knot();
    read_mesh object = read_mesh_file(of.object);
    say(object.remark);
    return std::move(object.surface);
  }
  static void say(const std::string& remark) {
    if (!remark.empty()) std::printf("%s\n", remark.c_str());
  }

  environment_map light_;
  scene scene_;
  render::image<shading_point> points_;
};

}  // namespace environment_lighting

#endif  // PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_CASES_HPP
