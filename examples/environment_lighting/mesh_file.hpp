// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_MESH_FILE_HPP
#define PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_MESH_FILE_HPP

#include <environment_lighting/mesh.hpp>
#include <papers/output_folder.hpp>

#include <phimis/core/finite.hpp>

#include <assimp/config.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/Importer.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>

namespace environment_lighting {

/// A mesh that can be rendered, and what had to be done to it, in one line; empty where nothing had.
struct read_mesh {
  mesh surface;
  std::string remark;
};

/// Without triangles of no area, the others moved and scaled into the unit sphere. `name` says of what.
///
/// Errors papers::cannot_run where a position is not finite, or no triangle is left.
inline read_mesh checked(mesh surface, const std::string& name) {
  vector low = vector::Constant(std::numeric_limits<float>::infinity()), high = -low;
  for (const vector& x : surface.positions) {
    for (int i = 0; i < 3; ++i) {
      if (!phimis::is_finite(x[i])) throw papers::cannot_run(name + ": a position is not finite");
    }
    low = low.cwiseMin(x), high = high.cwiseMax(x);
  }
  const vector centre = low + (high - low) / 2;
  const float size = (high - low).norm() / 2;
  for (vector& x : surface.positions) x = (x - centre) / size;

  const std::size_t before = surface.triangles.size();
  const std::size_t dropped = drop_flat(surface);
  if (surface.triangles.empty()) throw papers::cannot_run(name + ": no triangle with an area");
  if (surface.normals.empty()) smooth(surface);
  return {std::move(surface), dropped == 0 ? "" : name + ": left out " + std::to_string(dropped) + " of " +
                                                      std::to_string(before) + " triangles, which have no area"};
}

/// The triangles of an OBJ or PLY file, or whatever else assimp reads, with the file's normals or smooth ones.
///
/// Errors papers::cannot_run, which names the file, as `checked`, and where it cannot be read.
inline read_mesh read_mesh_file(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) throw papers::cannot_run("there is no " + file.string());
  Assimp::Importer importer;
  importer.SetPropertyInteger(AI_CONFIG_PP_SBP_REMOVE, aiPrimitiveType_POINT | aiPrimitiveType_LINE);
  const aiScene* const scene =
      importer.ReadFile(file.string(), aiProcess_Triangulate | aiProcess_PreTransformVertices |
                                           aiProcess_JoinIdenticalVertices | aiProcess_SortByPType);
  if (!scene) throw papers::cannot_run("cannot read " + file.string() + ": " + importer.GetErrorString());
  mesh surface;
  bool has_normals = true;
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) has_normals = has_normals && scene->mMeshes[m]->HasNormals();
  for (unsigned m = 0; m < scene->mNumMeshes; ++m) {
    const aiMesh& part = *scene->mMeshes[m];
    const auto first = static_cast<std::uint32_t>(surface.positions.size());
    const auto copy = [](const aiVector3D& v) { return vector(v.x, v.y, v.z); };
    for (unsigned i = 0; i < part.mNumVertices; ++i) {
      surface.positions.push_back(copy(part.mVertices[i]));
      if (!has_normals) continue;
      const vector n = copy(part.mNormals[i]);
      surface.normals.push_back(n.squaredNorm() > 0 ? n.normalized() : vector(0, 1, 0));
    }
    for (unsigned i = 0; i < part.mNumFaces; ++i) {
      const aiFace& face = part.mFaces[i];
      if (face.mNumIndices != 3) continue;
      surface.triangles.push_back({first + face.mIndices[0], first + face.mIndices[1], first + face.mIndices[2]});
    }
  }
  return checked(std::move(surface), file.string());
}

}  // namespace environment_lighting

#endif  // PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_MESH_FILE_HPP
