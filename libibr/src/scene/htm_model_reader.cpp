// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <cstring>

#include "base/check.h"
#include "ibr/htm_model.h"
#include "scene/gltf_values.h"
#include "scene/htm_model_file.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

using Accessor = GltfDocument::Accessor;

class HtmModelReader {
 public:
  explicit HtmModelReader(const fs::path& file) : gltf_(file) {}

  JsonValue extension() const { return extensionOf(gltf_, kHtmModelExtension, {.newest = kHtmModelVersion}); }
  const fs::path& folder() const { return gltf_.folder(); }

  HtmCamera camera(const JsonValue& entry) const {
    const NamedCamera named = namedCamera(gltf_, entry);
    if (named.camera.intrinsics.model != CameraModel::pinhole) entry["camera"]["model"].fault("is not PINHOLE");
    HtmCamera camera{named.name, named.camera, {}, {}};
    if (entry.has("given")) {
      const JsonValue given = entry["given"];
      camera.given =
          Camera{intrinsicsOf(given["camera"]), {vector3(given["translation"]), quaternion(given["rotation"])}};
      const Intrinsics &k = named.camera.intrinsics, &g = camera.given->intrinsics;
      if (g.model != k.model || g.width != k.width || g.height != k.height)
        given["camera"].fault("differs from the camera in model or size");
    }
    if (entry.has("image")) camera.imageFile = gltf_.reference(gltf_.element("images", entry["image"])["uri"]);
    if (entry.has("visibility")) camera.visibilityFile = gltf_.reference(entry["visibility"]["uri"]);
    return camera;
  }

  HtmSurface surface(const JsonValue& entry, std::size_t cameras) {
    const JsonValue node = gltf_.element("nodes", entry["node"]);
    if (gltf_.hasParent(node)) entry["node"].fault("is a child of another node; a surface needs a root node");
    for (const char* key : {"matrix", "rotation", "scale"})
      if (node.has(key)) node[key].fault("is not allowed: a surface has only a translation");
    const glm::dvec3 origin = node.has("translation") ? vector3(node["translation"]) : glm::dvec3(0.0);
    const JsonValue primitives = gltf_.element("meshes", node["mesh"])["primitives"];
    if (primitives.size() != 1) primitives.fault("does not have exactly one element");
    const JsonValue primitive = primitives.at(0);
    if (primitive.has("mode") && primitive["mode"].integer(0, 6) != 4) primitive["mode"].fault("is not TRIANGLES");
    const JsonValue attributes = primitive["attributes"];

    HtmSurface surface;
    const Accessor position = gltf_.accessor(attributes["POSITION"], "VEC3", {GltfDocument::kFloat});
    for (std::size_t v = 0; v < position.count; ++v) {
      const glm::vec3 offset(position.value(v, 0), position.value(v, 1), position.value(v, 2));
      if (!std::isfinite(offset.x) || !std::isfinite(offset.y) || !std::isfinite(offset.z))
        position.json.fault(fmt::format("element {} is not finite", v));
      surface.mesh.positions.push_back(origin + glm::dvec3(offset));
    }
    readMembers(gltf_.accessor(attributes["_MEMBERS"], "VEC4", {GltfDocument::kUnsignedShort}), cameras, surface);
    const Accessor index =
        gltf_.accessor(primitive["indices"], "SCALAR", {GltfDocument::kUnsignedShort, GltfDocument::kUnsignedInt});
    if (index.count % 3 != 0) index.json["count"].fault(fmt::format("{} is not a multiple of 3", index.count));
    for (std::size_t k = 0; k < index.count; ++k) {
      if (index.index(k) >= position.count)
        index.json.fault(fmt::format("element {}: {} is beyond the {} vertices", k, index.index(k), position.count));
      if (k % 3 == 0) surface.mesh.triangles.emplace_back(0u);
      surface.mesh.triangles.back()[int(k % 3)] = index.index(k);
    }
    return surface;
  }

  std::vector<glm::vec2> complements(const JsonValue& index, std::size_t cameras, std::size_t vertices) {
    const Accessor a = gltf_.accessor(index, "VEC2", {GltfDocument::kFloat});
    if (a.count != cameras * cameras * vertices)
      a.json["count"].fault(fmt::format("is {}, but {} cameras and {} vertices have {} complements", a.count, cameras,
                                        vertices, cameras * cameras * vertices));
    std::vector<glm::vec2> values(a.count);
    for (std::size_t k = 0; k < a.count; ++k) {
      values[k] = {a.value(k, 0), a.value(k, 1)};
      if (!std::isfinite(values[k].x) || !std::isfinite(values[k].y))
        a.json.fault(fmt::format("element {} is not finite", k));
    }
    return values;
  }

 private:
  static void readMembers(const Accessor& a, std::size_t cameras, HtmSurface& surface) {
    if (a.count != surface.mesh.positions.size())
      a.json["count"].fault(fmt::format("is {}, but POSITION has {}", a.count, surface.mesh.positions.size()));
    for (std::size_t v = 0; v < a.count; ++v) {
      CameraSet set = 0;
      for (std::size_t k = 0; k < 4; ++k) set |= CameraSet(a.index(4 * v + k)) << (16 * k);
      if (cameras < 64 && set >> cameras != 0)
        a.json.fault(fmt::format("element {}: {:#x} contains a camera beyond the {}", v, set, cameras));
      surface.members.push_back(set);
    }
  }

  GltfDocument gltf_;
};

// Reads as much as possible; skips surfaces if cameras have faults, since surfaces refer to them.
HtmModel readAll(const fs::path& file, FaultSink& sink) {
  HtmModelReader reader(file);
  HtmModel model;
  model.folder = reader.folder();
  const bool whole = sink.run([&] {
    const JsonValue extension = reader.extension(), cameras = extension["cameras"];
    if (extension.has("settings")) model.settings = extension["settings"].raw().dump();
    if (cameras.size() < 1 || cameras.size() > kMaxHtmCameraCount)
      cameras.fault(fmt::format("has {} elements, not 1 to {}", cameras.size(), kMaxHtmCameraCount));
    readNamed(cameras, "camera", "surfaces", model.cameras, sink,
              [&](const JsonValue& entry) { return reader.camera(entry); });
  });
  if (!whole) return model;
  const std::size_t cameras = model.cameras.size();
  sink.run([&] {
    model.surface = reader.surface(reader.extension()["surface"], cameras);
    if (reader.extension().has("complements"))
      model.complements = reader.complements(reader.extension()["complements"], cameras, model.vertexCount());
  });
  sink.run([&] {
    if (reader.extension().has("source")) model.source = reader.surface(reader.extension()["source"], cameras);
  });
  return model;
}

void checkFiles(const HtmModel& model, FaultSink& sink) {
  std::error_code ignored;
  const auto isThere = [&](const fs::path& file) { return fs::is_regular_file(model.folder / file, ignored); };
  for (std::size_t i = 0; i < model.cameras.size() && !sink.full(); ++i) {
    const HtmCamera& camera = model.cameras[i];
    const std::string at = fmt::format("/extensions/{}/cameras/{}", kHtmModelExtension, i);
    if (camera.imageFile.empty())
      sink.add(at, "has no \"image\", so the camera cannot be rendered");
    else if (!isThere(camera.imageFile))
      sink.add(at + "/image", fmt::format("{} is missing", camera.imageFile.string()));
    if (!camera.visibilityFile.empty() && !isThere(camera.visibilityFile))
      sink.add(at + "/visibility", fmt::format("{} is missing", camera.visibilityFile.string()));
  }
}

}  // namespace

HtmModel loadHtmModel(const fs::path& path) {
  return loadDocument(documentFile(path, kHtmModelFileName), readAll,
                      [](const HtmModel& model) { return validate(model, 1); });
}

std::vector<Fault> validateHtmModelFiles(const fs::path& path, std::size_t limit) {
  return faultsOfDocument(documentFile(path, kHtmModelFileName), limit, readAll, checkFiles);
}

}  // namespace ibr
