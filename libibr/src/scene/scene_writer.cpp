// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/common.hpp>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "base/check.h"
#include "base/file.h"
#include "ibr/scene.h"
#include "scene/json_check.h"
#include "scene/mesh_buffer.h"
#include "scene/scene_file.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

using Json = nlohmann::ordered_json;

constexpr int kFloat = 5126, kUnsignedShort = 5123, kUnsignedInt = 5125;  // glTF component types
constexpr int kVertices = 34962, kIndices = 34963;                        // glTF buffer view targets
constexpr int kPoints = 0, kTriangles = 4;                                // glTF primitive modes

Json triple(glm::dvec3 v) {
  return {v.x, v.y, v.z};
}

// FNV-1a: names files by their contents, nothing more.
std::uint64_t hashOf(std::span<const std::byte> bytes) {
  std::uint64_t hash = 0xcbf29ce484222325;
  for (const std::byte b : bytes) hash = (hash ^ std::uint64_t(b)) * 0x100000001b3;
  return hash;
}

Json cameraOf(const Intrinsics& k, const std::string& name) {
  constexpr double kNear = 0.01;  // glTF demands one; it means nothing here
  return {{"name", name},
          {"type", "perspective"},
          {"perspective",
           {{"aspectRatio", k.width / k.fx * k.fy / k.height},
            {"yfov", 2.0 * std::atan(0.5 * k.height / k.fy)},
            {"znear", kNear}}}};
}

Json exactCamera(const Intrinsics& k) {
  Json camera{{"model", k.model == CameraModel::pinhole ? "PINHOLE" : "EQUIRECTANGULAR"},
              {"width", k.width},
              {"height", k.height}};
  if (k.model == CameraModel::pinhole) camera.update({{"fx", k.fx}, {"fy", k.fy}, {"cx", k.cx}, {"cy", k.cy}});
  return camera;
}

// Of the outermost `levels` every entry has a line, the extension's lists too; what lies deeper stands in one line.
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

// What validate() cannot know: whether the scene's texts can stand in a JSON file, and its files beside it.
void checkTexts(const Scene& scene, const std::string& folder) {
  const auto demandUtf8 = [&](const std::string& text, const std::string& field) {
    try {
      Json(text).dump();
    } catch (const Json::exception&) {
      fail(ErrorCode::invalidInput, "{}: scene cannot be saved: {} is not UTF-8", folder, field);
    }
  };
  const auto demandInside = [&](const fs::path& file, const std::string& field) {
    const fs::path normal = file.lexically_normal();
    check(file.empty() || (file.is_relative() && normal != "." && *normal.begin() != ".."), ErrorCode::invalidInput,
          "{}: scene cannot be saved: {} \"{}\" leads outside the scene's folder", folder, field, file.string());
  };
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    demandUtf8(scene.nodes[n].name, fmt::format("nodes[{}].name", n));
    demandInside(scene.nodes[n].imageFile, fmt::format("nodes[{}].imageFile", n));
    demandInside(scene.nodes[n].textureFile, fmt::format("nodes[{}].textureFile", n));
  }
  for (std::size_t i = 0; i < scene.unused.size(); ++i) {
    demandUtf8(scene.unused[i].name, fmt::format("unused[{}].name", i));
    demandUtf8(scene.unused[i].reason, fmt::format("unused[{}].reason", i));
  }
  demandUtf8(scene.acquisition, "acquisition");
  try {
    if (!scene.settings.empty()) parseJson(scene.settings);
  } catch (const JsonFault& fault) {
    fail(ErrorCode::invalidInput, "{}: scene cannot be saved: settings {} {}", folder, fault.pointer(), fault.what());
  }
}

// Grows one glTF document.
class Writer {
 public:
  Writer(const Scene& scene, const fs::path& folder) : scene_(scene), folder_(folder) {
    for (const char* list :
         {"nodes", "cameras", "meshes", "buffers", "bufferViews", "accessors", "images", "textures", "materials"})
      lists_[list] = Json::array();
  }

  void addPhotograph(const Node& node) {
    glm::dquat q = node.camera.pose.rotation;
    // Left alone where it is a unit quaternion already, so that saving what was loaded changes no bit.
    if (const double length = glm::length(q); std::abs(length - 1.0) > 1e-15) q = q / length;
    Json json{
        {"name", node.name}, {"translation", triple(node.camera.pose.position)}, {"rotation", {q.x, q.y, q.z, q.w}}};
    if (node.camera.intrinsics.model == CameraModel::pinhole)
      json["camera"] = add("cameras", cameraOf(node.camera.intrinsics, node.name));
    Json entry{{"node", add("nodes", std::move(json))}, {"camera", exactCamera(node.camera.intrinsics)}};
    if (!node.imageFile.empty()) entry["image"] = add("images", {{"uri", encodeUri(node.imageFile)}});
    if (!node.textureFile.empty()) entry["texture"] = {{"uri", encodeUri(node.textureFile)}};
    photographs_.push_back(std::move(entry));
  }

  Json addCell(const Cell& cell, const std::string& name) {
    Json entry{{"members", cell.members}};
    const MeshLayout layout = layoutOf(cell.mesh);
    if (layout.points > 0) addMesh(cell, name, layout, entry);
    const CellQuality& quality = cell.quality;
    Json figures = Json::object();
    for (const auto& [key, value] : {std::pair{"coverage", quality.coverage}, std::pair{"ecc", quality.ecc},
                                     std::pair{"residualPx", quality.residualPx}, std::pair{"score", quality.score}})
      if (std::isfinite(value)) figures[key] = value;
    if (!figures.empty()) entry["quality"] = std::move(figures);
    return entry;
  }

  std::string document(Json cells, Json backdrops) {
    Json extension{{"version", kSceneVersion}};
    if (!scene_.acquisition.empty()) extension["acquisition"] = scene_.acquisition;
    if (!scene_.settings.empty()) extension["settings"] = parseJson(scene_.settings);
    if (scene_.origin)
      extension["origin"] = {{"latitudeDegrees", scene_.origin->latitudeDegrees},
                             {"longitudeDegrees", scene_.origin->longitudeDegrees},
                             {"heightMetres", scene_.origin->heightMetres}};
    for (const UnusedPhotograph& unused : scene_.unused)
      extension["unused"].push_back({{"name", unused.name}, {"reason", unused.reason}});
    extension["photographs"] = std::move(photographs_);
    extension["cells"] = std::move(cells);
    extension["backdrops"] = std::move(backdrops);

    Json gltf{{"asset", {{"version", "2.0"}, {"generator", "libibr"}}}};
    gltf["extensionsUsed"] = Json::array({kSceneExtension});
    if (!lists_["materials"].empty()) gltf["extensionsUsed"].push_back("KHR_materials_unlit");
    if (const std::size_t count = lists_["nodes"].size()) {
      Json all = Json::array();
      for (std::size_t n = 0; n < count; ++n) all.push_back(n);
      gltf["scene"] = 0;
      gltf["scenes"] = Json::array({Json{{"nodes", std::move(all)}}});
    }
    for (auto& [name, list] : lists_)
      if (!list.empty()) gltf[name] = std::move(list);
    gltf["extensions"] = {{kSceneExtension, std::move(extension)}};
    std::string text;
    print(gltf, 2, text);
    return text + '\n';
  }

  const std::set<std::string>& files() const { return files_; }

 private:
  std::size_t add(const char* list, Json entry) {
    lists_[list].push_back(std::move(entry));
    return lists_[list].size() - 1;
  }

  std::size_t addAccessor(std::size_t buffer, MeshLayout::Array array, std::size_t count, int component,
                          const char* type, int target) {
    Json view{{"buffer", buffer}, {"byteOffset", array.offset}, {"byteLength", array.bytes}};
    if (target) view["target"] = target;
    return add("accessors", {{"bufferView", add("bufferViews", std::move(view))},
                             {"componentType", component},
                             {"count", count},
                             {"type", type}});
  }

  void addMesh(const Cell& cell, const std::string& name, const MeshLayout& layout, Json& entry) {
    const std::vector<std::byte> bytes = encodeMesh(scene_, cell);
    const std::string file = fmt::format("cells/{}-{:016x}.bin", name, hashOf(bytes));
    writeFile(folder_ / file, bytes);
    files_.insert(fs::path(file).filename().string());
    const std::size_t buffer = add("buffers", {{"uri", file}, {"byteLength", bytes.size()}});

    const auto vertices = [&](MeshLayout::Array array, const char* type) {
      return addAccessor(buffer, array, layout.points, kFloat, type, kVertices);
    };
    Json attributes;
    attributes["POSITION"] = vertices(layout.position(), "VEC3");
    addBounds(bytes, layout, lists_["accessors"].back());
    for (std::size_t i = 0; i < layout.members; ++i)
      attributes[fmt::format("TEXCOORD_{}", i)] = vertices(layout.textureCoordinates(i), "VEC2");
    constexpr std::array kTypes{"SCALAR", "VEC2", "VEC3", "VEC4"};
    attributes["_RATIO"] = vertices(layout.ratio(), kTypes[layout.members - 1]);
    attributes["_INVERSE_DISTANCE"] = vertices(layout.inverseDistance(), "SCALAR");
    attributes["_UNCERTAINTY"] = vertices(layout.uncertainty(), "SCALAR");
    if (layout.hasPlanes)
      attributes["_PLANES"] = addAccessor(buffer, layout.planes(), layout.points, kUnsignedShort, "VEC4", kVertices);

    Json primitives = Json::array(), tiers = Json::array(), ecc = Json::array();
    for (int tier = 0; tier < 2; ++tier) {
      const std::size_t triangles = tier == 0 ? layout.tier0 : layout.tier1;
      if (triangles == 0) continue;
      Json primitive{{"attributes", attributes}, {"mode", kTriangles}};
      primitive["indices"] = addAccessor(buffer, layout.indices(tier), triangles * 3,
                                         layout.wideIndices() ? kUnsignedInt : kUnsignedShort, "SCALAR", kIndices);
      if (const auto material = materialOf(cell.members[0])) primitive["material"] = *material;
      primitives.push_back(std::move(primitive));
      tiers.push_back(tier);
      ecc.push_back(addAccessor(buffer, layout.ecc(tier), triangles, kFloat, "SCALAR", 0));
    }
    if (primitives.empty()) primitives.push_back({{"attributes", attributes}, {"mode", kPoints}});
    const std::size_t mesh = add("meshes", {{"name", name}, {"primitives", std::move(primitives)}});
    add("nodes", {{"name", name}, {"mesh", mesh}, {"translation", triple(displayOrigin(scene_, cell))}});
    entry["mesh"] = mesh;
    entry["tiers"] = std::move(tiers);
    entry["ecc"] = std::move(ecc);
  }

  static void addBounds(std::span<const std::byte> bytes, const MeshLayout& layout, Json& accessor) {
    glm::vec3 low(std::numeric_limits<float>::max()), high(-low);
    for (std::size_t p = 0; p < layout.points; ++p) {
      glm::vec3 position;
      std::memcpy(&position, &bytes[layout.position().offset + p * sizeof position], sizeof position);
      low = glm::min(low, position);
      high = glm::max(high, position);
    }
    accessor["min"] = {low.x, low.y, low.z};
    accessor["max"] = {high.x, high.y, high.z};
  }

  // The first member's photograph on the mesh, for viewers that do not know the extension.
  std::optional<std::size_t> materialOf(std::uint32_t node) {
    const Json& photograph = photographs_[node];
    if (!photograph.contains("image")) return std::nullopt;
    if (const auto known = materials_.find(node); known != materials_.end()) return known->second;
    const std::size_t texture = add("textures", {{"source", photograph["image"]}});
    const std::size_t material =
        add("materials", {{"name", scene_.nodes[node].name},
                          {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", texture}}}}},
                          {"doubleSided", true},
                          {"extensions", {{"KHR_materials_unlit", Json::object()}}}});
    return materials_[node] = material;
  }

  const Scene& scene_;
  fs::path folder_;
  std::map<std::string, Json> lists_;
  std::map<std::uint32_t, std::size_t> materials_;
  Json photographs_ = Json::array();
  std::set<std::string> files_;
};

// What an earlier scene in this folder used and this one does not.
void removeStaleCells(const fs::path& folder, const std::set<std::string>& used) {
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, ignored))
    if (entry.path().extension() == ".bin" && !used.contains(entry.path().filename().string()))
      fs::remove(entry.path(), ignored);
}

}  // namespace

void saveScene(const Scene& scene, const fs::path& folder) {
  if (const std::vector<Fault> faults = validate(scene, 1); !faults.empty())
    fail(ErrorCode::invalidInput, "{}: scene cannot be saved: {} {}", folder.string(), faults[0].field,
         faults[0].message);
  checkTexts(scene, folder.string());
  makeFolders(folder / "cells");
  Writer writer(scene, folder);
  for (const Node& node : scene.nodes) writer.addPhotograph(node);
  Json cells = Json::array(), backdrops = Json::array();
  for (std::size_t c = 0; c < scene.cells.size(); ++c)
    cells.push_back(writer.addCell(scene.cells[c], fmt::format("cell{:05}", c)));
  for (std::size_t b = 0; b < scene.backdrops.size(); ++b)
    backdrops.push_back(writer.addCell(scene.backdrops[b], fmt::format("backdrop{:05}", b)));
  writeFile(folder / kSceneFileName, writer.document(std::move(cells), std::move(backdrops)));
  removeStaleCells(folder / "cells", writer.files());
}

}  // namespace ibr
