// SPDX-License-Identifier: MIT
// Maps and meshes from files: what can be rendered is, what cannot is refused in one line that names the file.
#include "catch.hpp"

#include <environment_lighting/map_file.hpp>
#include <environment_lighting/mesh.hpp>
#include <environment_lighting/mesh_file.hpp>
#include <render/exr.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <numbers>
#include <string>
#include <utility>

namespace {

using namespace environment_lighting;

/// A folder that is gone at the end.
struct temporary_folder {
  temporary_folder() : path(std::filesystem::temp_directory_path() / "phimis_environment_files") {
    std::filesystem::create_directories(path);
  }
  ~temporary_folder() { std::filesystem::remove_all(path); }
  std::filesystem::path write(const std::string& name, const std::string& bytes) const {
    std::ofstream(path / name, std::ios::binary) << bytes;
    return path / name;
  }
  std::filesystem::path path;
};

render::image<render::rgb> grey(int width, int height) { return {width, height, {0.5f, 0.5f, 0.5f}}; }

/// The message with which f refuses, which is one line.
template <class F>
std::string refusal(const F& f) {
  try {
    f();
  } catch (const papers::cannot_run& error) {
    const std::string message = error.what();
    CHECK(message.find('\n') == std::string::npos);
    return message;
  }
  return "";
}

double area(const mesh& of) {
  double sum = 0;
  for (const auto& t : of.triangles) sum += static_cast<double>(area_normal(of, t).norm()) / 2;
  return sum;
}

/// Whether each edge belongs to two triangles that go along it in opposite directions.
bool closed(const mesh& of) {
  std::map<std::array<float, 6>, int> edges;  // by positions: the sphere has several vertices in one place
  for (const auto& t : of.triangles) {
    for (std::size_t i = 0; i < 3; ++i) {
      const vector &a = of.positions[t[i]], &b = of.positions[t[(i + 1) % 3]];
      ++edges[{a.x(), a.y(), a.z(), b.x(), b.y(), b.z()}];
    }
  }
  for (const auto& [edge, count] : edges) {
    const auto back = edges.find({edge[3], edge[4], edge[5], edge[0], edge[1], edge[2]});
    if (count != 1 || back == edges.end() || back->second != 1) return false;
  }
  return true;
}

}  // namespace

TEST_CASE("Negative texels become 0 and are counted, and so is a black map") {
  auto some = grey(4, 2);
  CHECK(checked(some, "some").remark.empty());
  some(1, 1).g = -0.25f;
  some(2, 0) = {-1, -1, -1};
  const read_map mended = checked(some, "some");
  CHECK(mended.remark == "some: 2 texels with a negative channel, taken as 0");
  CHECK((mended.radiance(1, 1) == render::rgb{0.5f, 0, 0.5f}));
  CHECK((mended.radiance(2, 0) == render::rgb{}));
  CHECK(checked(render::image<render::rgb>(4, 2), "none").remark == "none: the map is black");
  CHECK(checked(render::image<render::rgb>(1, 1, {-1, -1, -1}), "none").remark ==
        "none: 1 texels with a negative channel, taken as 0; the map is black");
}

TEST_CASE("A texel that is not finite is refused with its place") {
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                          -std::numeric_limits<float>::infinity()}) {
    auto some = grey(4, 3);
    some(3, 1).b = bad;
    some(0, 2).r = bad;
    CHECK(refusal([&] { checked(some, "some.exr"); }) ==
          "some.exr: 2 texels are not finite, the first in column 3, row 1");
  }
}

TEST_CASE("Maps come from OpenEXR and Radiance files, and from whole ones alone") {
  const temporary_folder folder;
  const std::filesystem::path exr = folder.path / "map.exr";
  auto some = grey(6, 3);
  some(5, 2) = {3, 2, 1};
  render::write_exr(exr, some);
  CHECK(read_map_file(exr).radiance.pixels == some.pixels);

  std::ifstream in(exr, std::ios::binary);
  const std::string bytes(std::istreambuf_iterator<char>(in), {});
  const auto broken = folder.write("broken.exr", bytes.substr(0, bytes.size() / 2));
  CHECK(refusal([&] { read_map_file(broken); }).find(broken.string()) != std::string::npos);
  const auto text = folder.write("text.exr", "no image");
  CHECK(refusal([&] { read_map_file(text); }).find(text.string()) != std::string::npos);
  CHECK(refusal([&] { read_map_file(folder.path / "none.exr"); }) ==
        "there is no " + (folder.path / "none.exr").string());
  const auto other = folder.write("map.png", "");
  CHECK(refusal([&] { read_map_file(other); }) == other.string() + ": a map is a file .exr or .hdr");

  // Two texels, uncompressed: 1 is mantissa 128 of exponent 129, 2^(129 − 136).
  const auto hdr = folder.write("map.HDR", std::string("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n") +
                                               "\x80\x40\x20\x81" + "\x80\x80\x80\x82");
  const read_map read = read_map_file(hdr);
  REQUIRE((read.radiance.width == 2 && read.radiance.height == 1));
  CHECK((read.radiance(0, 0) == render::rgb{1, 0.5f, 0.25f}));
  CHECK((read.radiance(1, 0) == render::rgb{2, 2, 2}));
  const auto no_hdr = folder.write("text.hdr", "no image");
  CHECK(refusal([&] { read_map_file(no_hdr); }).find("cannot read " + no_hdr.string()) == 0);
}

TEST_CASE("The sphere and the knot are closed, and lie in the unit sphere") {
  const mesh ball = sphere(), tangle = knot();
  CHECK(area(ball) == Approx(4 * std::numbers::pi).epsilon(1e-3));
  CHECK(closed(tangle));
  for (const mesh& of : {ball, tangle}) {
    REQUIRE(of.normals.size() == of.positions.size());
    double volume = 0;  // of a closed surface that faces outwards
    for (const auto& t : of.triangles) {
      const vector &a = of.positions[t[0]], &b = of.positions[t[1]], &c = of.positions[t[2]];
      volume += static_cast<double>(a.dot(b.cross(c))) / 6;
      REQUIRE(area_normal(of, t).norm() > 0);
      REQUIRE(area_normal(of, t).dot(of.normals[t[0]]) > 0);
    }
    CHECK(volume > 0.3);
    for (const vector& x : of.positions) REQUIRE(x.norm() < 1 + 1e-6f);
  }
}

TEST_CASE("Meshes come from OBJ and PLY files, without triangles of no area, in the unit sphere") {
  const temporary_folder folder;
  const std::string corners = "v 0 0 0\nv 4 0 0\nv 0 4 0\nv 0 0 4\n";
  const auto whole = folder.write("whole.obj", corners + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
  const read_mesh tetrahedron = read_mesh_file(whole);
  CHECK(tetrahedron.remark.empty());
  CHECK(tetrahedron.surface.triangles.size() == 4);
  CHECK(tetrahedron.surface.normals.size() == tetrahedron.surface.positions.size());
  for (const vector& x : tetrahedron.surface.positions) CHECK(x.norm() == Approx(1).epsilon(1e-6));

  const auto flat = folder.write("flat.obj", corners + "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\nf 1 1 2\nf 2 2 2\n");
  const read_mesh mended = read_mesh_file(flat);
  CHECK(mended.surface.triangles.size() == 4);
  CHECK(mended.remark == flat.string() + ": left out 2 of 6 triangles, which have no area");
  const auto none = folder.write("none.obj", corners + "f 1 1 2\n");
  CHECK(refusal([&] { read_mesh_file(none); }) == none.string() + ": no triangle with an area");

  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
  CHECK(read_mesh_file(folder.write("one.ply", ply + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")).surface.triangles.size() == 1);
  const auto broken = folder.write("broken.ply", ply + "0 0 0\n1 0");
  CHECK(refusal([&] { read_mesh_file(broken); }).find(broken.string()) != std::string::npos);
  const auto text = folder.write("text.obj", "no mesh\n");
  CHECK(refusal([&] { read_mesh_file(text); }).find(text.string()) != std::string::npos);
  CHECK(refusal([&] { read_mesh_file(folder.path / "none.ply"); }) ==
        "there is no " + (folder.path / "none.ply").string());
  mesh infinite = tetrahedron.surface;
  infinite.positions[2].y() = std::numeric_limits<float>::quiet_NaN();
  CHECK(refusal([&] { checked(infinite, "here"); }) == "here: a position is not finite");
}
