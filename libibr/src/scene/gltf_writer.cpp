// SPDX-License-Identifier: Apache-2.0
#include "scene/gltf_writer.h"

#include <cmath>
#include <glm/common.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>

#include "base/check.h"
#include "base/file.h"
#include "base/hash.h"
#include "scene/json_check.h"
#include "scene/scene_file.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

using Json = GltfWriter::Json;

// Hash of a file's contents, used in its name only.
std::uint64_t hashOf(std::span<const std::byte> bytes) {
  Hash hash;
  hash.add(bytes);
  return hash.value();
}

// True if addBuffer may have made the file name.
bool isBufferName(const std::string& name) {
  constexpr std::size_t kDigits = 16, kEnd = 4;  // of the hash; of ".bin"
  if (name.size() < kDigits + kEnd + 1 || !name.ends_with(".bin") || name[name.size() - kDigits - kEnd - 1] != '-')
    return false;
  return name.substr(name.size() - kDigits - kEnd, kDigits).find_first_not_of("0123456789abcdef") == std::string::npos;
}

Json cameraOf(const Intrinsics& k, const std::string& name) {
  constexpr double kNear = 0.01;  // required by glTF, unused here
  return {{"name", name},
          {"type", "perspective"},
          {"perspective",
           {{"aspectRatio", k.width / k.fx * k.fy / k.height},
            {"yfov", 2.0 * std::atan(0.5 * k.height / k.fy)},
            {"znear", kNear}}}};
}

// Prints each entry of the outermost `levels`, and of the extension's lists, on a line; deeper ones share a line.
void print(const Json& value, int levels, std::string& text) {
  if (levels == 0 || !value.is_structured() || value.empty()) {
    text += value.dump();
    return;
  }
  const char* separator = value.is_array() ? "[\n" : "{\n";
  for (const auto& [key, entry] : value.items()) {
    text += separator;
    separator = ",\n";
    if (value.is_object()) text += Json(key).dump() + ": ";
    print(entry, key == "extensions" ? 3 : levels - 1, text);
  }
  text += value.is_array() ? "\n]" : "\n}";
}

}  // namespace

GltfWriter::GltfWriter(fs::path folder) : folder_(std::move(folder)) {
  for (const char* list :
       {"nodes", "cameras", "meshes", "buffers", "bufferViews", "accessors", "images", "textures", "materials"})
    lists_[list] = Json::array();
}

std::size_t GltfWriter::add(const char* list, Json entry) {
  lists_[list].push_back(std::move(entry));
  return lists_[list].size() - 1;
}

std::size_t GltfWriter::addBuffer(const std::string& subfolder, const std::string& name,
                                  std::span<const std::byte> bytes) {
  const std::string file = fmt::format("{}/{}-{:016x}.bin", subfolder, name, hashOf(bytes));
  writeFile(folder_ / file, bytes);
  buffers_.insert(fs::path(file));
  return add("buffers", {{"uri", file}, {"byteLength", bytes.size()}});
}

std::size_t GltfWriter::addAccessor(Array array, std::size_t count, int component, const char* type, int target,
                                    std::size_t stride) {
  Json view{{"buffer", array.buffer}, {"byteOffset", array.offset}, {"byteLength", array.bytes}};
  if (target) view["target"] = target;
  if (stride) view["byteStride"] = stride;
  return add("accessors", {{"bufferView", add("bufferViews", std::move(view))},
                           {"componentType", component},
                           {"count", count},
                           {"type", type}});
}

void GltfWriter::addBounds(std::size_t accessor, std::span<const glm::vec3> positions) {
  glm::vec3 low(std::numeric_limits<float>::max()), high(-low);
  for (const glm::vec3& position : positions) {
    low = glm::min(low, position);
    high = glm::max(high, position);
  }
  entry("accessors", accessor)["min"] = {low.x, low.y, low.z};
  entry("accessors", accessor)["max"] = {high.x, high.y, high.z};
}

std::size_t GltfWriter::addCameraNode(const std::string& name, const Camera& camera) {
  glm::dquat q = camera.pose.rotation;
  // A unit quaternion stays unchanged, so that saving a loaded scene changes no bit.
  if (const double length = glm::length(q); std::abs(length - 1.0) > 1e-15) q = q / length;
  Json json{{"name", name}, {"translation", triple(camera.pose.position)}, {"rotation", {q.x, q.y, q.z, q.w}}};
  if (camera.intrinsics.model == CameraModel::pinhole)
    json["camera"] = add("cameras", cameraOf(camera.intrinsics, name));
  return add("nodes", std::move(json));
}

Json GltfWriter::intrinsicsJson(const Intrinsics& k) {
  Json camera{{"model", k.model == CameraModel::pinhole ? "PINHOLE" : "EQUIRECTANGULAR"},
              {"width", k.width},
              {"height", k.height}};
  if (k.model == CameraModel::pinhole) camera.update({{"fx", k.fx}, {"fy", k.fy}, {"cx", k.cx}, {"cy", k.cy}});
  return camera;
}

std::string GltfWriter::document(const char* extensionName, Json extension) {
  Json gltf{{"asset", {{"version", "2.0"}, {"generator", "libibr"}}}};
  gltf["extensionsUsed"] = Json::array({extensionName});
  if (!lists_["materials"].empty()) gltf["extensionsUsed"].push_back("KHR_materials_unlit");
  if (const std::size_t count = lists_["nodes"].size()) {
    Json all = Json::array();
    for (std::size_t n = 0; n < count; ++n) all.push_back(n);
    gltf["scene"] = 0;
    gltf["scenes"] = Json::array({Json{{"nodes", std::move(all)}}});
  }
  for (auto& [name, list] : lists_)
    if (!list.empty()) gltf[name] = std::move(list);
  gltf["extensions"] = {{extensionName, std::move(extension)}};
  std::string text;
  print(gltf, 2, text);
  return text + '\n';
}

void GltfWriter::removeStaleBuffers(const std::string& subfolder) const {
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder_ / subfolder, ignored))
    if (isBufferName(entry.path().filename().string()) &&
        !buffers_.contains(fs::path(subfolder) / entry.path().filename()))
      fs::remove(entry.path(), ignored);
}

void requireUtf8(const std::string& text, const fs::path& folder, const char* what, const std::string& field) {
  try {
    Json(text).dump();
  } catch (const Json::exception&) {
    fail(ErrorCode::invalidInput, "{}: {} cannot be saved: {} is not UTF-8", folder.string(), what, field);
  }
}

void requireInside(const fs::path& file, const fs::path& folder, const char* what, const std::string& field) {
  const fs::path normal = file.lexically_normal();
  check(file.empty() || (file.is_relative() && normal != "." && *normal.begin() != ".."), ErrorCode::invalidInput,
        "{}: {} cannot be saved: {} \"{}\" leads outside the {}'s folder", folder.string(), what, field, file.string(),
        what);
}

void requireJson(const std::string& text, const fs::path& folder, const char* what, const std::string& field) {
  try {
    if (!text.empty()) parseJson(text);
  } catch (const JsonFault& fault) {
    fail(ErrorCode::invalidInput, "{}: {} cannot be saved: {} {} {}", folder.string(), what, field, fault.pointer(),
         fault.what());
  }
}

}  // namespace ibr
