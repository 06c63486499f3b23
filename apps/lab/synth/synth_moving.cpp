// SPDX-License-Identifier: Apache-2.0
#include "lab/synth/synth_moving.h"

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <nlohmann/json.hpp>
#include <numbers>

#include "base/check.h"
#include "base/file.h"
#include "batch/files/colmap_views.h"
#include "ibr/author/htm.h"
#include "io/image_file.h"
#include "lab/generate/moving_figure.h"
#include "shared/cli/progress.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

constexpr int kCameras = 8;
constexpr double kDeviation = 0.004;  // of the inexact mesh's vertices, units of the figure, which is 1.7 high

// Camera on a circle around the figure, looking at its middle.
Camera cameraAt(double around, double height, PictureSize size) {
  const glm::dvec3 middle(0, 0.85, 0);
  const double angle = 2 * std::numbers::pi * around;
  const glm::dvec3 position(2.6 * std::sin(angle), height, 2.6 * std::cos(angle));
  const glm::dvec3 back = glm::normalize(position - middle), right = glm::normalize(glm::cross({0, 1, 0}, back));
  const glm::dmat3 axes(right, glm::cross(back, right), back);
  return {pinholeFromFov(size.width, size.height, 0.8), {position, glm::quat_cast(axes)}};
}

std::vector<View> views(int count, double shift, PictureSize size, const char* name) {
  std::vector<View> result;
  for (int i = 0; i < count; ++i)
    result.push_back({fmt::format("{}{:02}.png", name, i), cameraAt((i + shift) / count, i % 2 ? 1.5 : 0.7, size), 0});
  return result;
}

void writeFrame(const fs::path& folder, double phase, std::uint64_t seed, const std::vector<View>& cameras,
                const std::vector<View>& truth, const std::function<void()>& step) {
  const TexturedMesh figure = movingFigure(phase, seed);
  makeFolders(folder);
  writePly(folder / "mesh_exact.ply", figure.mesh);
  writePly(folder / "mesh.ply", inexactMesh(figure.mesh, kDeviation, phase, seed));
  writeColmapViews(folder / "sparse", cameras);
  const auto take = [&](const std::vector<View>& of, const fs::path& below) {
    makeFolders(below / "images");
    makeFolders(below / "masks");
    for (const View& view : of) {
      step();
      const MeshPhotograph picture = photograph(figure, view.camera);
      writeImage(below / "images" / view.name, picture.colours);
      writeImage(below / "masks" / view.name, picture.mask);
    }
  };
  take(cameras, folder);
  take(truth, folder / "truth");
  writeColmapViews(folder / "truth/sparse", truth);
}

}  // namespace

ExitCode synthesiseMoving(const MovingOptions& options, const Context& context) {
  const PictureSize size = options.size.width == 0 ? PictureSize{512, 512} : options.size;
  const std::vector<View> cameras = views(kCameras, 0, size, "cam");
  const std::vector<View> truth = views(options.views, 0.5, size, "truth");
  const std::size_t pictures = std::size_t(options.frames) * (cameras.size() + truth.size());
  const fs::path folder = options.output;
  {
    ProgressLine progress(context);
    std::size_t done = 0;
    const auto step = [&] {
      check(progress.show({"rendering the figure", done++, pictures}), ErrorCode::cancelled, "stopped");
    };
    for (int f = 0; f < options.frames; ++f)
      writeFrame(folder / fmt::format("frame{:04}", f), double(f) / options.frames, context.options().seed, cameras,
                 truth, step);
    progress.show({"rendering the figure", pictures, pictures});
  }
  const std::size_t faces = movingFigure(0, context.options().seed).mesh.triangles.size();
  context.print("{}: {} frames with {} cameras and {} truth views each; {} faces\n", options.output, options.frames,
                cameras.size(), truth.size(), faces);
  context.report(nlohmann::ordered_json{{"folder", options.output},
                                        {"frames", options.frames},
                                        {"cameras", cameras.size()},
                                        {"views", truth.size()},
                                        {"faces", faces}});
  return kExitOk;
}

}  // namespace ibr::app
