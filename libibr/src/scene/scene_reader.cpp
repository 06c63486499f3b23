// SPDX-License-Identifier: Apache-2.0
// Reads scene.gltf and the cells' buffers through GltfDocument; all input is untrusted.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <set>

#include "base/check.h"
#include "base/stop.h"
#include "ibr/scene.h"
#include "ibr/texture.h"
#include "scene/gltf_document.h"
#include "scene/gltf_values.h"
#include "scene/mesh_buffer.h"
#include "scene/scene_faults.h"
#include "scene/scene_file.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

using Accessor = GltfDocument::Accessor;

constexpr const char* kStage = "loading the scene";  // for errors

class SceneReader {
 public:
  SceneReader(const fs::path& file, const std::stop_token& stop) : gltf_(file, stop) {}

  JsonValue extension() const {
    return extensionOf(gltf_, kSceneExtension,
                       {kSceneVersion, kSceneVersion, "build the scene again with `ibr build`"});
  }

  void facts(Scene& scene) const {
    const JsonValue extension = this->extension();
    scene.folder = gltf_.folder();
    if (extension.has("acquisition")) scene.acquisition = extension["acquisition"].string();
    if (extension.has("settings")) scene.settings = extension["settings"].raw().dump();
    if (extension.has("unused")) {
      const JsonValue unused = extension["unused"];
      for (std::size_t i = 0; i < unused.size(); ++i)
        scene.unusedPhotographs.push_back({unused.at(i)["name"].string(), unused.at(i)["reason"].string()});
    }
    if (extension.has("origin")) {
      const JsonValue origin = extension["origin"];
      scene.origin = GeographicOrigin{origin["latitudeDegrees"].number(), origin["longitudeDegrees"].number(),
                                      origin["heightMetres"].number()};
    }
  }

  Node node(const JsonValue& entry) const {
    Node node;
    NamedCamera named = namedCamera(gltf_, entry);
    node.name = std::move(named.name);
    node.camera = named.camera;
    if (entry.has("image")) node.imageFile = gltf_.reference(gltf_.element("images", entry["image"])["uri"]);
    if (entry.has("texture")) node.textureFile = gltf_.reference(entry["texture"]["uri"]);
    if (entry.has("capture")) node.capture = capture(entry["capture"]);
    if (entry.has("gain")) {
      node.gain = vector3(entry["gain"]);
      for (std::size_t c = 0; c < 3; ++c) within(entry["gain"].at(c), 1 / kMaxGain, kMaxGain);
    }
    if (entry.has("mask")) node.maskFile = gltf_.reference(entry["mask"]["uri"]);
    if (entry.has("depth")) {
      node.depthFile = gltf_.reference(entry["depth"]["uri"]);
      node.depthScale = positive(entry["depth"]["scale"]);
    }
    return node;
  }

  Cell cell(const JsonValue& entry, const Scene& scene, std::size_t least, std::size_t most) {
    Cell cell;
    const JsonValue members = entry["members"];
    if (members.size() < least || members.size() > most)
      members.fault(fmt::format("has {} members, not {} to {}", members.size(), least, most));
    for (std::size_t i = 0; i < members.size(); ++i) {
      const auto member = std::uint32_t(members.at(i).index(scene.nodes.size()));
      if (std::count(cell.members.begin(), cell.members.end(), member))
        members.at(i).fault(fmt::format("node {} is a member twice", member));
      cell.members.push_back(member);
    }
    cell.mesh.match.resize(cell.members.size());
    cell.mesh.ratio.resize(cell.members.size());
    if (entry.has("mesh")) mesh(entry, scene, cell);
    if (entry.has("quality")) {
      const JsonValue quality = entry["quality"];
      constexpr double kAny = std::numeric_limits<double>::infinity();
      if (quality.has("coverage")) cell.quality.coverage = within(quality["coverage"], 0, 1);
      if (quality.has("ecc")) cell.quality.ecc = within(quality["ecc"], -1, 1);
      if (quality.has("residualPx")) cell.quality.residualPx = within(quality["residualPx"], 0, kAny);
      if (quality.has("score")) cell.quality.score = within(quality["score"], 0, 1);
    }
    return cell;
  }

 private:
  static CaptureMetadata capture(const JsonValue& entry) {
    CaptureMetadata facts;
    for (const auto& [key, value] : kCaptureNumbers)
      if (entry.has(key)) facts.*value = positive(entry[key]);
    for (const auto& [key, text] : kCaptureTexts)
      if (entry.has(key)) facts.*text = entry[key].string();
    return facts;
  }

  // Reads one component of a float attribute and checks each value.
  template <class Check>
  static std::vector<float> floats(const Accessor& a, std::size_t component, Check&& holds, const char* what) {
    std::vector<float> values(a.count);
    for (std::size_t i = 0; i < a.count; ++i) {
      values[i] = a.value(i, component);
      if (!std::isfinite(values[i]) || !holds(values[i]))
        a.json.fault(fmt::format("element {}: {} {}", i, values[i], what));
    }
    return values;
  }

  void mesh(const JsonValue& entry, const Scene& scene, Cell& cell) {
    const JsonValue primitives = gltf_.element("meshes", entry["mesh"])["primitives"];
    const JsonValue tiers = entry["tiers"], ecc = entry["ecc"];
    if (primitives.size() < 1 || primitives.size() > 2) primitives.fault("does not have one or two elements");
    if (tiers.size() > primitives.size()) tiers.fault("has more elements than the mesh has primitives");
    if (ecc.size() != tiers.size()) ecc.fault("does not have as many elements as \"tiers\"");
    vertices(primitives.at(0)["attributes"], scene, cell);
    for (std::size_t k = 0; k < tiers.size(); ++k) {
      const JsonValue primitive = primitives.at(k);
      if (primitive["attributes"].raw() != primitives.at(0)["attributes"].raw())
        primitive["attributes"].fault("differ from those of the first primitive");
      if (primitive.has("mode") && primitive["mode"].integer(0, 6) != 4) primitive["mode"].fault("is not TRIANGLES");
      const auto tier = tiers.at(k).integer(0, 1);
      if (k > 0 && tier <= tiers.at(k - 1).integer(0, 1)) tiers.at(k).fault("is not greater than the previous tier");
      triangles(primitive["indices"], ecc.at(k), std::uint8_t(tier), cell.mesh);
    }
  }

  void vertices(const JsonValue& attributes, const Scene& scene, Cell& cell) {
    constexpr int kFloat = GltfDocument::kFloat;
    constexpr std::array kTypes{"SCALAR", "VEC2", "VEC3", "VEC4"};
    const std::size_t d = cell.members.size();
    MorphMesh& mesh = cell.mesh;
    const auto any = [](float) { return true; };
    const Accessor ratio = gltf_.accessor(attributes["_RATIO"], kTypes[d - 1], {kFloat});
    const std::size_t points = ratio.count;
    const auto sized = [&](Accessor a) {
      if (a.count != points) a.json["count"].fault(fmt::format("is {}, but _RATIO has {}", a.count, points));
      return a;
    };
    for (std::size_t i = 0; i < d; ++i) {
      mesh.ratio[i] = floats(
          ratio, i, [](float v) { return v > 0; }, "is not positive");
      const Accessor at = sized(gltf_.accessor(attributes[fmt::format("TEXCOORD_{}", i).c_str()], "VEC2", {kFloat}));
      const std::vector<float> u = floats(at, 0, any, "is not finite"), v = floats(at, 1, any, "is not finite");
      const Intrinsics& k = scene.nodes[cell.members[i]].camera.intrinsics;
      for (std::size_t p = 0; p < points; ++p)
        mesh.match[i].emplace_back(matchFromTexture(u[p], k.width), matchFromTexture(v[p], k.height));
    }
    const auto notNegative = [](float v) { return v >= 0; };
    mesh.inverseDistance = floats(sized(gltf_.accessor(attributes["_INVERSE_DISTANCE"], "SCALAR", {kFloat})), 0,
                                  notNegative, "is negative or not finite");
    mesh.uncertainty = floats(sized(gltf_.accessor(attributes["_UNCERTAINTY"], "SCALAR", {kFloat})), 0, notNegative,
                              "is negative or not finite");
    if (attributes.has("_PLANES")) {
      const Accessor planes = sized(gltf_.accessor(attributes["_PLANES"], "VEC4", {GltfDocument::kUnsignedShort}));
      for (std::size_t p = 0; p < points; ++p) {
        glm::u16vec4 set;
        for (int k = 0; k < 4; ++k) set[k] = std::uint16_t(planes.index(4 * p + std::size_t(k)));
        if (!isPlaneSet(set))
          planes.json.fault(fmt::format("element {}: ({}, {}, {}, {}) is not an ascending list padded with zeros", p,
                                        set.x, set.y, set.z, set.w));
        mesh.planes.push_back(set);
      }
    }
    if (attributes.has("_CONFIRMATIONS") || attributes.has("_CONSENSUS")) {
      const Accessor counts =
          sized(gltf_.accessor(attributes["_CONFIRMATIONS"], "SCALAR", {GltfDocument::kUnsignedByte}));
      for (std::size_t p = 0; p < points; ++p) mesh.confirmations.push_back(std::uint8_t(counts.index(p)));
      mesh.consensus = floats(
          sized(gltf_.accessor(attributes["_CONSENSUS"], "SCALAR", {kFloat})), 0,
          [](float v) { return v >= 0 && v <= 1; }, "is not within 0 to 1");
    }
    const Accessor position = sized(gltf_.accessor(attributes["POSITION"], "VEC3", {kFloat}));
    const std::vector<glm::vec3> derived = displayPositions(scene, cell);
    for (std::size_t p = 0; p < points; ++p) {
      const glm::vec3 stored(position.value(p, 0), position.value(p, 1), position.value(p, 2));
      constexpr float kTolerance = 1e-3f;  // relative; floats and the order of operations differ
      if (!(glm::distance(stored, derived[p]) <= kTolerance * glm::length(derived[p]) + 1e-6f))
        position.json.fault(
            fmt::format("element {}: ({}, {}, {}) contradicts the position from matches, ratios and inverse "
                        "distance, ({}, {}, {})",
                        p, stored.x, stored.y, stored.z, derived[p].x, derived[p].y, derived[p].z));
    }
  }

  void triangles(const JsonValue& indices, const JsonValue& ecc, std::uint8_t tier, MorphMesh& mesh) {
    const Accessor list = gltf_.accessor(indices, "SCALAR", {GltfDocument::kUnsignedShort, GltfDocument::kUnsignedInt});
    if (list.count % 3 != 0) list.json["count"].fault(fmt::format("{} is not a multiple of 3", list.count));
    const Accessor labels = gltf_.accessor(ecc, "SCALAR", {GltfDocument::kFloat});
    if (labels.count != list.count / 3)
      labels.json["count"].fault(fmt::format("is {}, but there are {} triangles", labels.count, list.count / 3));
    const std::vector<float> values = floats(
        labels, 0, [](float v) { return std::abs(v) <= 1; }, "is not within -1 to 1");
    mesh.ecc.insert(mesh.ecc.end(), values.begin(), values.end());
    for (std::size_t t = 0; t < list.count; t += 3) {
      const glm::uvec3 v(list.index(t), list.index(t + 1), list.index(t + 2));
      for (int k = 0; k < 3; ++k)
        if (v[k] >= mesh.vertexCount())
          list.json.fault(
              fmt::format("element {}: {} is beyond the {} points", t + std::size_t(k), v[k], mesh.vertexCount()));
      mesh.triangles.push_back(v);
      mesh.tier.push_back(tier);
    }
  }

  GltfDocument gltf_;
};

// Reads as much as possible; skips cells if nodes have faults, since cells refer to them.
Scene readAll(const fs::path& file, FaultSink& sink, const std::stop_token& stop) {
  SceneReader reader(file, stop);
  Scene scene;
  sink.run([&] { reader.facts(scene); });
  bool whole = sink.run([&] {
    readNamed(reader.extension()["photographs"], "photograph", "cells", scene.nodes, sink, [&](const JsonValue& entry) {
      checkStop(stop, kStage);
      return reader.node(entry);
    });
  });
  if (!whole) return scene;
  const auto read = [&](const char* list, std::size_t least, std::size_t most, std::vector<Cell>& cells) {
    sink.run([&] {
      const JsonValue entries = reader.extension()[list];
      for (std::size_t c = 0; c < entries.size() && !sink.full(); ++c)
        sink.run([&] {
          checkStop(stop, kStage);
          cells.push_back(reader.cell(entries.at(c), scene, least, most));
        });
    });
  };
  read("cells", 2, 4, scene.cells);
  read("backdrops", 1, 1, scene.backdrops);
  std::set<std::uint32_t> covered;
  for (std::size_t b = 0; b < scene.backdrops.size(); ++b)
    if (const std::uint32_t node = scene.backdrops[b].members[0]; !covered.insert(node).second)
      sink.run([&] { reader.extension()["backdrops"].fault(fmt::format("photograph {} has two backdrops", node)); });
  return scene;
}

void checkDepthFile(const fs::path& folder, const Node& node, const std::string& at, FaultSink& sink) {
  const std::string name = node.depthFile.string();
  const Intrinsics& k = node.camera.intrinsics;
  try {
    const Ktx2Info depth = probeKtx2(folder / node.depthFile);
    if (depth.format != TextureFormat::rg16f)
      sink.add(at, fmt::format("{} has the format {}, not rg16f", name, textureFormatName(depth.format)));
    else if (depth.levels != 1)
      sink.add(at, fmt::format("{} has {} levels, not 1", name, depth.levels));
    else if (depth.width > k.width || depth.height > k.height)
      sink.add(at, fmt::format("{} is {}x{}, larger than its photograph of {}x{}", name, depth.width, depth.height,
                               k.width, k.height));
  } catch (const Error& e) {
    sink.add(at, e.what());
  }
}

void checkFiles(const Scene& scene, FaultSink& sink) {
  for (std::size_t n = 0; n < scene.nodes.size() && !sink.full(); ++n) {
    const Node& node = scene.nodes[n];
    const std::string at = fmt::format("/extensions/{}/photographs/{}", kSceneExtension, n);
    std::error_code ignored;
    if (!node.imageFile.empty() && !fs::is_regular_file(scene.folder / node.imageFile, ignored))
      sink.add(at + "/image", fmt::format("{} is missing", node.imageFile.string()));
    if (!node.maskFile.empty() && !fs::is_regular_file(scene.folder / node.maskFile, ignored))
      sink.add(at + "/mask", fmt::format("{} is missing", node.maskFile.string()));
    if (!node.depthFile.empty()) checkDepthFile(scene.folder, node, at + "/depth", sink);
    if (node.textureFile.empty()) {
      sink.add(at, "has no \"texture\", so the photograph cannot be rendered");
      continue;
    }
    const Intrinsics& k = node.camera.intrinsics;
    try {
      const Ktx2Info texture = probeKtx2(scene.folder / node.textureFile);
      const int levels = std::bit_width(unsigned(std::max(k.width, k.height)));
      if (texture.width != k.width || texture.height != k.height || texture.levels != levels)
        sink.add(at + "/texture",
                 fmt::format("{} is {}x{} with {} levels; the camera needs {}x{} with {}", node.textureFile.string(),
                             texture.width, texture.height, texture.levels, k.width, k.height, levels));
      if (texture.format == TextureFormat::rg16f)
        sink.add(at + "/texture", fmt::format("{} holds depth (rg16f), not a photograph", node.textureFile.string()));
      if (!node.maskFile.empty() && texture.format == TextureFormat::bc1)
        sink.add(at + "/texture", fmt::format("{} is BC1, which has no alpha for the mask", node.textureFile.string()));
    } catch (const Error& e) {
      sink.add(at + "/texture", e.what());
    }
  }
}

}  // namespace

Scene loadScene(const fs::path& path, const std::stop_token& stop) {
  return loadDocument(
      documentFile(path, kSceneFileName),
      [&](const fs::path& file, FaultSink& sink) { return readAll(file, sink, stop); },
      [&](const Scene& scene) { return faultsOf(scene, 1, stop); });
}

std::vector<Fault> validateSceneFiles(const fs::path& path, std::size_t limit) {
  return faultsOfDocument<Scene>(
      documentFile(path, kSceneFileName), limit,
      [](const fs::path& file, FaultSink& sink) { return readAll(file, sink, {}); }, checkFiles);
}

}  // namespace ibr
