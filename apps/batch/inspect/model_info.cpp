// SPDX-License-Identifier: Apache-2.0
#include "batch/inspect/model_info.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <map>
#include <nlohmann/json.hpp>

#include "ibr/htm_sequence.h"
#include "shared/report/table.h"

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

// RMS of the complements between different cameras that are both members of the vertex.
double complementRms(const HtmModel& model) {
  double sum = 0;
  std::size_t count = 0;
  const std::size_t cameras = model.cameras.size();
  for (std::size_t i = 0; i < cameras && !model.complements.empty(); ++i)
    for (std::size_t j = 0; j < cameras; ++j)
      for (std::size_t v = 0; v < model.vertexCount(); ++v) {
        const CameraSet both = CameraSet(1) << i | CameraSet(1) << j;
        if (i == j || (model.surface.members[v] & both) != both) continue;
        const glm::dvec2 complement = model.complements[model.complementIndex(i, j, v)];
        sum += glm::dot(complement, complement);
        ++count;
      }
  return count > 0 ? std::sqrt(sum / double(count)) : 0.0;
}

}  // namespace

ExitCode showModel(const std::string& path, const Context& context) {
  const HtmModel model = loadHtmModel(path);
  const std::size_t cameras = model.cameras.size(), vertices = model.vertexCount();
  const std::size_t faces = model.surface.mesh.triangles.size();
  const std::size_t predicted = vertices * cameras * cameras * sizeof(glm::vec2);
  const std::size_t real = model.complements.size() * sizeof(glm::vec2);
  std::size_t members = 0, unseen = 0;
  for (const CameraSet set : model.surface.members) {
    members += std::size_t(std::popcount(set));
    unseen += set == 0;
  }
  const double meanMembers = vertices > 0 ? double(members) / double(vertices) : 0.0;
  const double rms = complementRms(model);

  Json report{{"model", path},
              {"cameras", cameras},
              {"vertices", vertices},
              {"faces", faces},
              {"membersPerVertex", meanMembers},
              {"verticesWithoutCamera", unseen},
              {"complementRmsPx", rms},
              {"complementBytes", {{"predicted", predicted}, {"real", real}}},
              {"source", nullptr}};
  std::map<std::pair<int, int>, std::size_t> sizes;
  for (const HtmCamera& camera : model.cameras)
    ++sizes[{camera.camera.intrinsics.width, camera.camera.intrinsics.height}];
  context.print("cameras      {}", cameras);
  for (const auto& [size, count] : sizes) context.print(", {} of {}×{}", count, size.first, size.second);
  context.print("\nmesh         {} faces, {} vertices\n", faces, vertices);
  if (model.source) {
    context.print("source mesh  {} faces, {} vertices\n", model.source->mesh.triangles.size(),
                  model.source->mesh.positions.size());
    report["source"] = {{"vertices", model.source->mesh.positions.size()},
                        {"faces", model.source->mesh.triangles.size()}};
  }
  context.print("visibility   {:.1f} cameras per vertex; {} vertices without camera\n", meanMembers, unseen);
  context.print("complements  {:.2f} px RMS; {} predicted, {} actual{}\n", rms, bytesText(double(predicted)),
                bytesText(double(real)), real == 0 ? ": all are 0" : "");
  context.report(report);
  return kExitOk;
}

ExitCode showSequence(const std::string& path, const Context& context) {
  const HtmSequenceIndex index = loadHtmSequence(path);
  std::error_code ignored;
  const std::filesystem::path given = path;
  const std::filesystem::path folder = std::filesystem::is_directory(given, ignored) ? given : given.parent_path();
  std::size_t faces = 0, vertices = 0, cameras = 0;  // maximum over the frames
  std::uint64_t pictures = 0, complements = 0;       // bytes on the device, maximum of each over the frames
  for (const std::filesystem::path& frame : index.frames) {
    const HtmModel model = loadHtmModel(folder / frame);
    faces = std::max(faces, model.surface.mesh.triangles.size());
    vertices = std::max(vertices, model.vertexCount());
    cameras = std::max(cameras, model.cameras.size());
    std::uint64_t bytes = 0;
    for (const HtmCamera& camera : model.cameras)
      bytes += 4 * std::uint64_t(camera.camera.intrinsics.width) * std::uint64_t(camera.camera.intrinsics.height);
    pictures = std::max(pictures, bytes);
    complements = std::max<std::uint64_t>(complements, model.complements.size() * sizeof(glm::vec2));
  }
  const double seconds = double(index.frames.size()) / index.fps;
  context.print("frames       {} at {} per second: {:.2f} s\n", index.frames.size(), index.fps, seconds);
  context.print("per frame    at most {} faces, {} vertices, {} cameras; {} of images, {} of complements\n", faces,
                vertices, cameras, bytesText(double(pictures)), bytesText(double(complements)));
  context.report(Json{{"sequence", path},
                      {"frames", index.frames.size()},
                      {"fps", index.fps},
                      {"seconds", seconds},
                      {"faces", faces},
                      {"vertices", vertices},
                      {"cameras", cameras},
                      {"pictureBytes", pictures},
                      {"complementBytes", complements}});
  return kExitOk;
}

}  // namespace ibr::app
