// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <glm/common.hpp>

#include "base/check.h"
#include "base/file.h"
#include "ibr/htm_model.h"
#include "scene/gltf_writer.h"
#include "scene/htm_model_file.h"
#include "scene/json_check.h"
#include "scene/scene_file.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

using Json = GltfWriter::Json;

static_assert(std::endian::native == std::endian::little, "buffers are copied without byte swapping");

struct Placed {
  glm::dvec3 origin;
  std::vector<glm::vec3> offsets;
};

// Origin and offsets lie on one grid, so that their sum is exact and a loaded model is saved unchanged.
Placed place(const std::vector<glm::dvec3>& positions) {
  glm::dvec3 low = positions[0], high = positions[0];
  for (const glm::dvec3& p : positions) {
    low = glm::min(low, p);
    high = glm::max(high, p);
  }
  const glm::dvec3 size = high - low;
  const double extent = std::max({size.x, size.y, size.z});
  int exponent = 0;
  std::frexp(extent > 0 ? extent : 1.0, &exponent);  // extent < 2^exponent
  const double coarse = std::ldexp(1.0, exponent - 3), fine = std::ldexp(1.0, exponent - 23);
  Placed result{glm::round(0.5 * (low + high) / coarse) * coarse, {}};
  for (const glm::dvec3& p : positions) result.offsets.emplace_back(glm::round((p - result.origin) / fine) * fine);
  return result;
}

// Concatenates arrays, each aligned to 4 bytes.
class Buffer {
 public:
  template <class T>
  GltfWriter::Array append(const std::vector<T>& values) {
    const std::size_t offset = (bytes_.size() + 3) & ~std::size_t(3), size = values.size() * sizeof(T);
    bytes_.resize(offset + size);
    std::memcpy(bytes_.data() + offset, values.data(), size);
    return {0, offset, size};
  }
  const std::vector<std::byte>& bytes() const { return bytes_; }

 private:
  std::vector<std::byte> bytes_;
};

class Writer {
 public:
  explicit Writer(const fs::path& folder) : gltf_(folder) {}

  Json camera(const HtmCamera& camera) {
    Json entry{{"node", gltf_.addCameraNode(camera.name, camera.camera)},
               {"camera", GltfWriter::intrinsicsJson(camera.camera.intrinsics)}};
    if (!camera.imageFile.empty()) entry["image"] = gltf_.add("images", {{"uri", encodeUri(camera.imageFile)}});
    if (!camera.visibilityFile.empty()) entry["visibility"] = {{"uri", encodeUri(camera.visibilityFile)}};
    if (camera.given) {
      const glm::dquat& q = camera.given->pose.rotation;
      entry["given"] = {{"translation", GltfWriter::triple(camera.given->pose.position)},
                        {"rotation", {q.x, q.y, q.z, q.w}},
                        {"camera", GltfWriter::intrinsicsJson(camera.given->intrinsics)}};
    }
    return entry;
  }

  Json surface(const HtmSurface& surface, const char* name) {
    const TriangleMesh& mesh = surface.mesh;
    const Placed placed = place(mesh.positions);
    const bool isWide = mesh.positions.size() > 65535;
    std::vector<std::uint32_t> wide;
    std::vector<std::uint16_t> narrow;
    for (const glm::uvec3& t : mesh.triangles)
      for (int k = 0; k < 3; ++k) {
        if (isWide)
          wide.push_back(t[k]);
        else
          narrow.push_back(std::uint16_t(t[k]));
      }
    Buffer buffer;
    GltfWriter::Array positions = buffer.append(placed.offsets), members = buffer.append(surface.members),
                      indices = isWide ? buffer.append(wide) : buffer.append(narrow);
    positions.buffer = members.buffer = indices.buffer = gltf_.addBuffer(kHtmModelBuffers, name, buffer.bytes());

    const std::size_t count = mesh.positions.size();
    const std::size_t position = gltf_.addAccessor(positions, count, GltfWriter::kFloat, "VEC3", GltfWriter::kVertices);
    gltf_.addBounds(position, placed.offsets);
    Json attributes{
        {"POSITION", position},
        {"_MEMBERS", gltf_.addAccessor(members, count, GltfWriter::kUnsignedShort, "VEC4", GltfWriter::kVertices)}};
    const std::size_t index = gltf_.addAccessor(indices, mesh.triangles.size() * 3,
                                                isWide ? GltfWriter::kUnsignedInt : GltfWriter::kUnsignedShort,
                                                "SCALAR", GltfWriter::kIndices);
    Json primitive{{"attributes", std::move(attributes)}, {"mode", GltfWriter::kTriangles}, {"indices", index}};
    const std::size_t meshIndex = gltf_.add("meshes", {{"name", name}, {"primitives", Json::array({primitive})}});
    const std::size_t node =
        gltf_.add("nodes", {{"name", name}, {"mesh", meshIndex}, {"translation", GltfWriter::triple(placed.origin)}});
    return {{"node", node}};
  }

  std::size_t complements(const std::vector<glm::vec2>& values) {
    Buffer buffer;
    GltfWriter::Array array = buffer.append(values);
    array.buffer = gltf_.addBuffer(kHtmModelBuffers, "complements", buffer.bytes());
    return gltf_.addAccessor(array, values.size(), GltfWriter::kFloat, "VEC2");
  }

  GltfWriter& gltf() { return gltf_; }

 private:
  GltfWriter gltf_;
};

void checkWritable(const HtmModel& model, const fs::path& folder) {
  if (const std::vector<Fault> faults = validate(model, 1); !faults.empty())
    fail(ErrorCode::invalidInput, "{}: model cannot be saved: {} {}", folder.string(), faults[0].field,
         faults[0].message);
  check(!model.surface.mesh.triangles.empty() && !(model.source && model.source->mesh.triangles.empty()),
        ErrorCode::invalidInput, "{}: model cannot be saved: a surface has no triangle", folder.string());
  for (std::size_t i = 0; i < model.cameras.size(); ++i) {
    requireUtf8(model.cameras[i].name, folder, "model", fmt::format("cameras[{}].name", i));
    requireInside(model.cameras[i].imageFile, folder, "model", fmt::format("cameras[{}].imageFile", i));
    requireInside(model.cameras[i].visibilityFile, folder, "model", fmt::format("cameras[{}].visibilityFile", i));
  }
  requireJson(model.settings, folder, "model", "settings");
}

}  // namespace

void saveHtmModel(const HtmModel& model, const fs::path& folder) {
  checkWritable(model, folder);
  makeFolders(folder / kHtmModelBuffers);
  Writer writer(folder);
  Json extension{{"version", kHtmModelVersion}};
  if (!model.settings.empty()) extension["settings"] = parseJson(model.settings);
  extension["cameras"] = Json::array();
  for (const HtmCamera& camera : model.cameras) extension["cameras"].push_back(writer.camera(camera));
  extension["surface"] = writer.surface(model.surface, "surface");
  if (!model.complements.empty()) extension["complements"] = writer.complements(model.complements);
  if (model.source) extension["source"] = writer.surface(*model.source, "source");
  writeFile(folder / kHtmModelFileName, writer.gltf().document(kHtmModelExtension, std::move(extension)));
  writer.gltf().removeStaleBuffers(kHtmModelBuffers);
}

}  // namespace ibr
