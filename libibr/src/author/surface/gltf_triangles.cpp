// SPDX-License-Identifier: Apache-2.0
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>

#include "author/surface/triangle_mesh_file.h"
#include "base/check.h"
#include "scene/gltf_document.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

constexpr int kTriangles = 4, kStrip = 5, kFan = 6;  // glTF primitive modes

glm::dmat4 placement(const JsonValue& node) {
  const auto numbers = [&](const char* key, std::size_t count, glm::dvec4 otherwise) {
    if (!node.has(key)) return otherwise;
    if (node[key].size() != count) node[key].fault(fmt::format("is not a list of {} numbers", count));
    for (std::size_t k = 0; k < count; ++k) otherwise[int(k)] = node[key].at(k).number();
    return otherwise;
  };
  if (node.has("matrix")) {
    glm::dmat4 matrix;
    if (node["matrix"].size() != 16) node["matrix"].fault("is not a list of 16 numbers");
    for (int k = 0; k < 16; ++k) matrix[k / 4][k % 4] = node["matrix"].at(std::size_t(k)).number();
    return matrix;
  }
  const glm::dvec4 q = numbers("rotation", 4, {0, 0, 0, 1});
  const glm::dmat4 moved = glm::translate(glm::dmat4(1.0), glm::dvec3(numbers("translation", 3, glm::dvec4(0.0))));
  return glm::scale(moved * glm::mat4_cast(glm::dquat(q.w, q.x, q.y, q.z)),
                    glm::dvec3(numbers("scale", 3, glm::dvec4(1.0))));
}

class Collector {
 public:
  explicit Collector(const fs::path& path) : document_(path) {}

  TriangleMesh read() {
    const JsonValue root = document_.root();
    if (root.has("scenes") && root.has("scene")) {
      const JsonValue scene = document_.element("scenes", root["scene"]);
      if (scene.has("nodes"))
        for (std::size_t n = 0; n < scene["nodes"].size(); ++n)
          add(document_.element("nodes", scene["nodes"].at(n)), glm::dmat4(1.0));
    } else if (root.has("nodes")) {
      for (std::size_t n = 0; n < root["nodes"].size(); ++n)
        if (const JsonValue node = root["nodes"].at(n); !document_.hasParent(node)) add(node, glm::dmat4(1.0));
    }
    return std::move(mesh_);
  }

 private:
  void add(const JsonValue& node, const glm::dmat4& parent) {
    if (!visited_.insert(&node.raw()).second) node.fault("is in the node tree twice");
    const glm::dmat4 toWorld = parent * placement(node);
    if (node.has("mesh")) {
      const JsonValue primitives = document_.element("meshes", node["mesh"])["primitives"];
      for (std::size_t p = 0; p < primitives.size(); ++p) addPrimitive(primitives.at(p), toWorld);
    }
    if (node.has("children"))
      for (std::size_t c = 0; c < node["children"].size(); ++c)
        add(document_.element("nodes", node["children"].at(c)), toWorld);
  }

  void addPrimitive(const JsonValue& primitive, const glm::dmat4& toWorld) {
    const auto mode = primitive.has("mode") ? int(primitive["mode"].integer(0, 6)) : kTriangles;
    if (mode < kTriangles) return;  // points and lines
    const auto positions = document_.accessor(primitive["attributes"]["POSITION"], "VEC3", {GltfDocument::kFloat});
    const auto first = std::uint32_t(mesh_.positions.size());
    if (first + std::uint64_t(positions.count) > 0xffffffff) primitive.fault("has too many vertices");
    for (std::size_t v = 0; v < positions.count; ++v)
      mesh_.positions.push_back(toWorld *
                                glm::dvec4(positions.value(v, 0), positions.value(v, 1), positions.value(v, 2), 1.0));
    std::vector<std::uint32_t> corners;
    if (primitive.has("indices")) {
      const auto indices =
          document_.accessor(primitive["indices"], "SCALAR",
                             {GltfDocument::kUnsignedByte, GltfDocument::kUnsignedShort, GltfDocument::kUnsignedInt});
      for (std::size_t k = 0; k < indices.count; ++k) {
        corners.push_back(indices.index(k));
        if (corners.back() >= positions.count)
          primitive["indices"].fault(
              fmt::format("has vertex index {}, but there are {} vertices", corners.back(), positions.count));
      }
    } else {
      for (std::uint32_t v = 0; v < positions.count; ++v) corners.push_back(v);
    }
    if (mode == kTriangles && corners.size() % 3 != 0)
      primitive.fault(fmt::format("has {} corners, which is not a multiple of 3", corners.size()));
    const bool mirrored = glm::determinant(glm::dmat3(toWorld)) < 0;
    const std::size_t step = mode == kTriangles ? 3 : 1;
    for (std::size_t k = 0; k + 2 < corners.size(); k += step) {
      glm::uvec3 t(corners[k], corners[k + 1], corners[k + 2]);
      if (mode == kFan) t.x = corners[0];
      if (mirrored != (mode == kStrip && k % 2 == 1)) std::swap(t.y, t.z);
      mesh_.triangles.push_back(t + first);
    }
  }

  GltfDocument document_;
  std::set<const nlohmann::json*> visited_;
  TriangleMesh mesh_;
};

}  // namespace

TriangleMesh readGltfTriangles(const fs::path& path) {
  try {
    return Collector(path).read();
  } catch (const JsonFault& fault) {
    fail(ErrorCode::invalidInput, "{}: {} {}", path.string(), fault.pointer(), fault.what());
  }
}

}  // namespace ibr
