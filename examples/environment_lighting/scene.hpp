// SPDX-License-Identifier: MIT
#ifndef PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_SCENE_HPP
#define PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_SCENE_HPP

#include <environment_lighting/environment_map.hpp>
#include <environment_lighting/mesh.hpp>
#include <papers/output_folder.hpp>
#include <render/direction.hpp>
#include <render/image.hpp>
#include <render/light_sample.hpp>
#include <render/max_phong.hpp>
#include <render/parallel.hpp>

#include <embree3/rtcore.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>

namespace environment_lighting {

/// Of a point of the unit object.
struct material {
  render::rgb albedo{0.8f, 0.8f, 0.8f};
  float diffuse = 1;  ///< k_d of a max-Phong of albedo one; k_s is the rest
  float exponent = 0;
};

/// What a pixel sees: a point of the object, or only what the map emits.
struct shading_point : render::seen_point {
  vector position{0, 0, 0};  ///< from which rays to the map start, a little above the surface
  render::max_phong surface;  ///< of albedo one: none of its samples is absorbed
  render::rgb albedo{};
};

/// An object within a cage of occluders, which only shadow rays hit: a camera ray goes through.
///
/// Errors papers::cannot_run where Embree has no memory for it.
class scene {
 public:
  scene(mesh object, const mesh& occluders, const environment_map& light,
        std::function<material(const vector&)> material_at)
      : object_(std::move(object)), light_(light), material_at_(std::move(material_at)) {
    RTCDevice device = rtcNewDevice(nullptr);
    if (!device) throw papers::cannot_run("Embree cannot start");
    device_.reset(device);
    scene_.reset(rtcNewScene(device));
    rtcSetSceneFlags(scene_.get(), RTC_SCENE_FLAG_ROBUST);
    add(object_, of_object);
    add(occluders, of_occluders);
    rtcCommitScene(scene_.get());
    if (rtcGetDeviceError(device) != RTC_ERROR_NONE) throw papers::cannot_run("Embree cannot build the scene");
  }

  const environment_map& light() const { return light_; }

  /// The point in the middle of a pixel; the object fills the lesser side of the image.
  shading_point shade(int x, int y, int width, int height) const {
    const vector eye(0, 1.2f, 4);
    const vector forward = -eye.normalized();
    const vector right = forward.cross(vector::UnitY()).normalized();
    const vector up = right.cross(forward);
    const float pixel = 0.54f / static_cast<float>(std::min(width, height));
    const vector direction =
        (forward + right * ((static_cast<float>(x) + 0.5f - static_cast<float>(width) / 2) * pixel) +
         up * ((static_cast<float>(height) / 2 - static_cast<float>(y) - 0.5f) * pixel))
            .normalized();
    RTCRayHit hit{};
    set_ray(hit.ray, eye, direction, of_object);
    hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene_.get(), &context, &hit);
    shading_point point;
    if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) {
      point.emitted = light_.radiance(light_.directions().find(direction));
      return point;
    }
    const auto& corners = object_.triangles[hit.hit.primID];
    const vector view = -direction;
    vector flat = area_normal(object_, corners).normalized();
    if (flat.dot(view) < 0) flat = -flat;
    vector normal = object_.normals[corners[0]] * (1 - hit.hit.u - hit.hit.v) + object_.normals[corners[1]] * hit.hit.u +
                    object_.normals[corners[2]] * hit.hit.v;
    normal = normal.squaredNorm() > 0 ? vector(normal.normalized()) : flat;
    if (normal.dot(flat) < 0) normal = -normal;
    if (!(normal.dot(view) > 1e-3f)) normal = flat;  // a smooth normal may face away at an outline
    const vector on_surface = eye + direction * hit.ray.tfar;
    const material of = material_at_(on_surface);
    point.part = 0;
    point.position = on_surface + flat * 1e-4f;
    point.surface = render::max_phong(normal, view, of.exponent, of.diffuse, 1 - of.diffuse);
    point.albedo = of.albedo;
    return point;
  }

  /// Whether the map is seen from a point in a direction.
  bool sees_light(const shading_point& from, const vector& direction) const {
    RTCRay ray{};
    set_ray(ray, from.position, direction, of_object | of_occluders);
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcOccluded1(scene_.get(), &context, &ray);
    return ray.tfar >= 0;
  }

 private:
  static constexpr unsigned of_object = 1, of_occluders = 2;

  void add(const mesh& of, unsigned mask) {
    if (of.triangles.empty()) return;
    const RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
    void* const positions = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                                    sizeof(vector), of.positions.size());
    void* const triangles = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                                    3 * sizeof(std::uint32_t), of.triangles.size());
    if (!positions || !triangles) throw papers::cannot_run("not enough memory for the mesh");
    std::memcpy(positions, of.positions.data(), of.positions.size() * sizeof(vector));
    std::memcpy(triangles, of.triangles.data(), of.triangles.size() * 3 * sizeof(std::uint32_t));
    rtcSetGeometryMask(geometry, mask);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_.get(), geometry);
    rtcReleaseGeometry(geometry);
  }

  static void set_ray(RTCRay& ray, const vector& from, const vector& direction, unsigned mask) {
    ray.org_x = from.x(), ray.org_y = from.y(), ray.org_z = from.z();
    ray.dir_x = direction.x(), ray.dir_y = direction.y(), ray.dir_z = direction.z();
    ray.tnear = 0;
    ray.tfar = std::numeric_limits<float>::infinity();
    ray.mask = mask;
  }

  struct release {
    void operator()(RTCDevice of) const { rtcReleaseDevice(of); }
    void operator()(RTCScene of) const { rtcReleaseScene(of); }
  };

  mesh object_;
  const environment_map& light_;
  std::function<material(const vector&)> material_at_;
  std::unique_ptr<RTCDeviceTy, release> device_;
  std::unique_ptr<RTCSceneTy, release> scene_;
};

/// What the pixels of an image see.
inline render::image<shading_point> shading_points(const scene& of, int width, int height, int threads) {
  render::image<shading_point> points(width, height);
  render::for_each_tile(width, height, threads, [&](const render::tile& t) {
    render::for_each_pixel(t, [&](int x, int y) { points(x, y) = of.shade(x, y, width, height); });
  });
  return points;
}

}  // namespace environment_lighting

#endif  // PHIMIS_EXAMPLES_ENVIRONMENT_LIGHTING_SCENE_HPP
