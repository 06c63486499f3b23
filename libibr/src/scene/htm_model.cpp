// SPDX-License-Identifier: Apache-2.0
#include "ibr/htm_model.h"

#include <set>

#include "scene/scene_faults.h"

namespace ibr {
namespace {

CameraSet allCameras(std::size_t count) {
  return count >= 64 ? ~CameraSet(0) : (CameraSet(1) << count) - 1;
}

void checkSurface(const HtmSurface& surface, std::size_t cameras, const std::string& at, Faults& faults) {
  const std::size_t vertices = surface.mesh.positions.size();
  for (std::size_t v = 0; v < vertices && !faults.full(); ++v)
    if (!finite(surface.mesh.positions[v])) faults.add(fmt::format("{}.mesh.positions[{}]", at, v), "is not finite");
  for (std::size_t t = 0; t < surface.mesh.triangles.size() && !faults.full(); ++t) {
    const glm::uvec3 corner = surface.mesh.triangles[t];
    if (corner.x >= vertices || corner.y >= vertices || corner.z >= vertices)
      faults.add(fmt::format("{}.mesh.triangles[{}]", at, t), "({}, {}, {}) has an index beyond the {} vertices",
                 corner.x, corner.y, corner.z, vertices);
  }
  if (surface.members.size() != vertices)
    faults.add(at + ".members", "has {} values, not {}", surface.members.size(), vertices);
  const CameraSet others = ~allCameras(cameras);
  for (std::size_t v = 0; v < surface.members.size() && !faults.full(); ++v)
    if (surface.members[v] & others)
      faults.add(fmt::format("{}.members[{}]", at, v), "{:#x} contains a camera beyond the {}", surface.members[v],
                 cameras);
}

}  // namespace

std::vector<Fault> validate(const HtmModel& model, std::size_t limit) {
  Faults faults(limit);
  const std::size_t cameras = model.cameras.size();
  if (cameras < 1 || cameras > kMaxHtmCameraCount)
    faults.add("cameras", "has {} elements, not 1 to {}", cameras, kMaxHtmCameraCount);
  std::set<std::string> names;
  for (std::size_t i = 0; i < cameras && !faults.full(); ++i) {
    const std::string at = fmt::format("cameras[{}]", i);
    const HtmCamera& camera = model.cameras[i];
    if (camera.name.empty()) faults.add(at + ".name", "is empty");
    if (!names.insert(camera.name).second) faults.add(at + ".name", "\"{}\" is not unique", camera.name);
    if (camera.camera.intrinsics.model != CameraModel::pinhole)
      faults.add(at + ".camera.intrinsics", "is not a pinhole camera");
    checkCamera(camera.camera, at + ".camera", faults);
    if (!camera.given) continue;
    checkCamera(*camera.given, at + ".given", faults);
    const Intrinsics &k = camera.camera.intrinsics, &g = camera.given->intrinsics;
    if (g.model != k.model || g.width != k.width || g.height != k.height)
      faults.add(at + ".given.intrinsics", "differs from the camera in model or size");
  }
  checkSurface(model.surface, cameras, "surface", faults);
  if (model.source) checkSurface(*model.source, cameras, "source", faults);
  const std::size_t complements = cameras * cameras * model.vertexCount();
  if (!model.complements.empty() && model.complements.size() != complements)
    faults.add("complements", "has {} values, not {}", model.complements.size(), complements);
  for (std::size_t k = 0; k < model.complements.size() && !faults.full(); ++k)
    if (!finite(glm::dvec3(model.complements[k], 0.0))) faults.add(fmt::format("complements[{}]", k), "is not finite");
  return faults.take();
}

}  // namespace ibr
