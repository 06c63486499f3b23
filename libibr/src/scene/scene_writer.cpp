// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>

#include "base/check.h"
#include "base/file.h"
#include "ibr/scene.h"
#include "scene/gltf_writer.h"
#include "scene/json_check.h"
#include "scene/mesh_buffer.h"
#include "scene/scene_file.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

using Json = GltfWriter::Json;

constexpr int kFloat = GltfWriter::kFloat;

// Checks beyond validate(): texts must be valid in a JSON file, and file names inside the folder.
void checkTexts(const Scene& scene, const fs::path& folder) {
  for (std::size_t n = 0; n < scene.nodes.size(); ++n) {
    requireUtf8(scene.nodes[n].name, folder, "scene", fmt::format("nodes[{}].name", n));
    requireInside(scene.nodes[n].imageFile, folder, "scene", fmt::format("nodes[{}].imageFile", n));
    requireInside(scene.nodes[n].textureFile, folder, "scene", fmt::format("nodes[{}].textureFile", n));
    for (const auto& [key, text] : kCaptureTexts)
      requireUtf8(scene.nodes[n].capture.*text, folder, "scene", fmt::format("nodes[{}].capture.{}", n, key));
    requireInside(scene.nodes[n].maskFile, folder, "scene", fmt::format("nodes[{}].maskFile", n));
    requireInside(scene.nodes[n].depthFile, folder, "scene", fmt::format("nodes[{}].depthFile", n));
  }
  for (std::size_t i = 0; i < scene.unusedPhotographs.size(); ++i) {
    requireUtf8(scene.unusedPhotographs[i].name, folder, "scene", fmt::format("unused[{}].name", i));
    requireUtf8(scene.unusedPhotographs[i].reason, folder, "scene", fmt::format("unused[{}].reason", i));
  }
  requireUtf8(scene.acquisition, folder, "scene", "acquisition");
  requireJson(scene.settings, folder, "scene", "settings");
}

class Writer {
 public:
  Writer(const Scene& scene, const fs::path& folder) : scene_(scene), gltf_(folder) {}

  void addPhotograph(const Node& node) {
    Json entry{{"node", gltf_.addCameraNode(node.name, node.camera)},
               {"camera", GltfWriter::intrinsicsJson(node.camera.intrinsics)}};
    if (!node.imageFile.empty()) entry["image"] = gltf_.add("images", {{"uri", encodeUri(node.imageFile)}});
    if (!node.textureFile.empty()) entry["texture"] = {{"uri", encodeUri(node.textureFile)}};
    Json capture = Json::object();
    for (const auto& [key, text] : kCaptureTexts)
      if (!(node.capture.*text).empty()) capture[key] = node.capture.*text;
    for (const auto& [key, value] : kCaptureNumbers)
      if (node.capture.*value > 0) capture[key] = node.capture.*value;
    if (!capture.empty()) entry["capture"] = std::move(capture);
    if (node.gain != glm::dvec3(1.0)) entry["gain"] = {node.gain.r, node.gain.g, node.gain.b};
    if (!node.maskFile.empty()) entry["mask"] = {{"uri", encodeUri(node.maskFile)}};
    if (!node.depthFile.empty()) entry["depth"] = {{"uri", encodeUri(node.depthFile)}, {"scale", node.depthScale}};
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
    for (const UnusedPhotograph& unused : scene_.unusedPhotographs)
      extension["unused"].push_back({{"name", unused.name}, {"reason", unused.reason}});
    extension["photographs"] = std::move(photographs_);
    extension["cells"] = std::move(cells);
    extension["backdrops"] = std::move(backdrops);

    return gltf_.document(kSceneExtension, std::move(extension));
  }

  void removeStaleCells() const { gltf_.removeStaleBuffers("cells"); }

 private:
  void addMesh(const Cell& cell, const std::string& name, const MeshLayout& layout, Json& entry) {
    const std::vector<std::byte> bytes = encodeMesh(scene_, cell);
    const std::size_t buffer = gltf_.addBuffer("cells", name, bytes);
    const auto array = [&](MeshLayout::Array a) { return GltfWriter::Array{buffer, a.offset, a.bytes}; };
    const auto vertices = [&](MeshLayout::Array a, const char* type) {
      return gltf_.addAccessor(array(a), layout.points, kFloat, type, GltfWriter::kVertices);
    };
    Json attributes;
    const std::size_t position = vertices(layout.position(), "VEC3");
    attributes["POSITION"] = position;
    std::vector<glm::vec3> positions(layout.points);
    std::memcpy(positions.data(), &bytes[layout.position().offset], layout.position().bytes);
    gltf_.addBounds(position, positions);
    for (std::size_t i = 0; i < layout.members; ++i)
      attributes[fmt::format("TEXCOORD_{}", i)] = vertices(layout.textureCoordinates(i), "VEC2");
    constexpr std::array kTypes{"SCALAR", "VEC2", "VEC3", "VEC4"};
    attributes["_RATIO"] = vertices(layout.ratio(), kTypes[layout.members - 1]);
    attributes["_INVERSE_DISTANCE"] = vertices(layout.inverseDistance(), "SCALAR");
    attributes["_UNCERTAINTY"] = vertices(layout.uncertainty(), "SCALAR");
    if (layout.hasPlanes)
      attributes["_PLANES"] = gltf_.addAccessor(array(layout.planes()), layout.points, GltfWriter::kUnsignedShort,
                                                "VEC4", GltfWriter::kVertices);
    if (layout.hasEvidence) {
      attributes["_CONFIRMATIONS"] =
          gltf_.addAccessor(array(layout.confirmations()), layout.points, GltfWriter::kUnsignedByte, "SCALAR",
                            GltfWriter::kVertices, MeshLayout::kConfirmationsStride);
      attributes["_CONSENSUS"] = vertices(layout.consensus(), "SCALAR");
    }

    Json primitives = Json::array(), tiers = Json::array(), ecc = Json::array();
    for (int tier = 0; tier < 2; ++tier) {
      const std::size_t triangles = tier == 0 ? layout.tier0 : layout.tier1;
      if (triangles == 0) continue;
      Json primitive{{"attributes", attributes}, {"mode", GltfWriter::kTriangles}};
      primitive["indices"] = gltf_.addAccessor(
          array(layout.indices(tier)), triangles * 3,
          layout.wideIndices() ? GltfWriter::kUnsignedInt : GltfWriter::kUnsignedShort, "SCALAR", GltfWriter::kIndices);
      if (const auto material = materialOf(cell.members[0])) primitive["material"] = *material;
      primitives.push_back(std::move(primitive));
      tiers.push_back(tier);
      ecc.push_back(gltf_.addAccessor(array(layout.ecc(tier)), triangles, kFloat, "SCALAR"));
    }
    if (primitives.empty()) primitives.push_back({{"attributes", attributes}, {"mode", GltfWriter::kPoints}});
    const std::size_t mesh = gltf_.add("meshes", {{"name", name}, {"primitives", std::move(primitives)}});
    gltf_.add("nodes",
              {{"name", name}, {"mesh", mesh}, {"translation", GltfWriter::triple(displayOrigin(scene_, cell))}});
    entry["mesh"] = mesh;
    entry["tiers"] = std::move(tiers);
    entry["ecc"] = std::move(ecc);
  }

  // Puts the first member's photograph on the mesh, for viewers without support for the extension.
  std::optional<std::size_t> materialOf(std::uint32_t node) {
    const Json& photograph = photographs_[node];
    if (!photograph.contains("image")) return std::nullopt;
    if (const auto known = materials_.find(node); known != materials_.end()) return known->second;
    const std::size_t texture = gltf_.add("textures", {{"source", photograph["image"]}});
    const std::size_t material =
        gltf_.add("materials", {{"name", scene_.nodes[node].name},
                                {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", texture}}}}},
                                {"doubleSided", true},
                                {"extensions", {{"KHR_materials_unlit", Json::object()}}}});
    return materials_[node] = material;
  }

  const Scene& scene_;
  GltfWriter gltf_;
  std::map<std::uint32_t, std::size_t> materials_;
  Json photographs_ = Json::array();
};

}  // namespace

void saveScene(const Scene& scene, const fs::path& folder) {
  if (const std::vector<Fault> faults = validate(scene, 1); !faults.empty())
    fail(ErrorCode::invalidInput, "{}: scene cannot be saved: {} {}", folder.string(), faults[0].field,
         faults[0].message);
  checkTexts(scene, folder);
  makeFolders(folder / "cells");
  Writer writer(scene, folder);
  for (const Node& node : scene.nodes) writer.addPhotograph(node);
  Json cells = Json::array(), backdrops = Json::array();
  for (std::size_t c = 0; c < scene.cells.size(); ++c)
    cells.push_back(writer.addCell(scene.cells[c], fmt::format("cell{:05}", c)));
  for (std::size_t b = 0; b < scene.backdrops.size(); ++b)
    backdrops.push_back(writer.addCell(scene.backdrops[b], fmt::format("backdrop{:05}", b)));
  writeFile(folder / kSceneFileName, writer.document(std::move(cells), std::move(backdrops)));
  writer.removeStaleCells();
}

}  // namespace ibr
