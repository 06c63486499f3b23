// SPDX-License-Identifier: Apache-2.0
// Synthetic scenes with exact truth, as test input and ground truth for all other commands.
#include <cmath>
#include <glm/geometric.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

#include "base/check.h"
#include "base/file.h"
#include "base/random.h"
#include "batch/command.h"
#include "batch/files/colmap_views.h"
#include "ibr/texture.h"
#include "io/image_file.h"
#include "lab/generate/synthetic.h"
#include "lab/lab_commands.h"
#include "lab/synth/synth_court.h"
#include "lab/synth/synth_grid.h"
#include "lab/synth/synth_moving.h"
#include "lab/synth/synth_noise.h"
#include "lab/synth/synth_walk.h"
#include "shared/camera/camera_path.h"
#include "shared/cli/options.h"
#include "shared/cli/progress.h"
#include "shared/cli/settings.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

constexpr double kPi = std::numbers::pi;

enum class Kind { planes, roomPano, roomMixed, grid, moving, court, walk, noise };

struct Options {
  Kind kind = Kind::planes;
  std::string output;
  int members = 3, views = 8, side = 10, frames = 8, photographs = 50;
  WalkVideoOptions walk;
  NoiseOptions noise;
  PictureSize size;
  TextureFormat texture = TextureFormat::rgba8;
};

glm::dquat turned(double yaw, double pitch) {
  return glm::angleAxis(yaw, glm::dvec3(0, 1, 0)) * glm::angleAxis(pitch, glm::dvec3(1, 0, 0));
}

// Two to four photographs a metre apart. A fourth is above the others, so that the cell is a tetrahedron.
SyntheticOptions optionsOf(const Options& options, std::uint64_t seed) {
  Random random(seed);
  const bool panoramas = options.kind == Kind::roomPano || options.kind == Kind::roomMixed;
  PictureSize size = options.size;
  if (size.width == 0) size = panoramas ? PictureSize{1024, 512} : PictureSize{640, 480};
  SyntheticOptions made;
  for (const glm::dvec3 place : {glm::dvec3(0, 0, 0), {1, 0, 0}, {0.5, 0, -0.87}, {0.5, 0.8, -0.3}}) {
    Camera camera{{CameraModel::equirectangular, size.width, size.height}, {place, {1, 0, 0, 0}}};
    if (!panoramas || (options.kind == Kind::roomMixed && made.cameras.empty())) {
      const PictureSize pinhole = panoramas ? PictureSize{640, 480} : size;
      camera.intrinsics = pinholeFromFov(pinhole.width, pinhole.height, 1.2);
      camera.pose.rotation = turned(random.uniform(-0.05, 0.05), random.uniform(-0.05, 0.05));
    } else {
      camera.pose.rotation = turned(random.uniform(-kPi, kPi), random.uniform(-0.1, 0.1));
    }
    made.cameras.push_back(camera);
  }
  made.cameras.resize(std::size_t(options.members));
  if (panoramas) {
    made.planes = roomPlanes({-2.5, -1.6, -3.5}, {3.6, 1.9, 2.2}, 0.12, seed);
    made.surfaceStep = 0.5;
  } else {
    made.planes = {{{0.5, 0, -8}, {1, 0, 0}, {0, 1, 0}, 40, 30, seed, 0.3},
                   {{-0.6, 0.3, -4.5}, {1, 0, 0}, {0, 1, 0}, 1.6, 1.2, seed + 1, 0.2},
                   {{1.7, -0.5, -5.5}, glm::normalize(glm::dvec3(1, 0, 0.4)), {0, 1, 0}, 1.5, 2.0, seed + 2, 0.2}};
    made.gridStep = 16;
  }
  if (options.kind == Kind::grid) {
    made.cameras.resize(3);
    for (Camera& camera : made.cameras) camera.pose.rotation = {1, 0, 0, 0};
    made.planes.resize(1);
    made.atInfinity = true;
    made.gridStep = 128;
  }
  made.samplesPerAxis = 3;
  return made;
}

// Positions inside the cell; every third one is moved outwards by up to a quarter of an edge. Views of panorama rooms
// look in all directions, the first three up, down and back.
std::vector<View> truthViews(const Options& options, const std::vector<Camera>& cameras, std::uint64_t seed) {
  Random random(seed + 1000);
  std::vector<View> views;
  for (int v = 0; v < options.views; ++v) {
    std::vector<double> weights;
    double sum = 0;
    for (std::size_t i = 0; i < cameras.size(); ++i) {
      weights.push_back(-std::log(random.uniform(1e-9, 1)));  // normalised: uniform over the simplex
      sum += weights.back();
    }
    glm::dvec3 place(0), middle(0);
    for (std::size_t i = 0; i < cameras.size(); ++i) {
      place += weights[i] / sum * cameras[i].pose.position;
      middle += cameras[i].pose.position / double(cameras.size());
    }
    if (v % 3 == 2) place += random.uniform(0.1, 0.25) * (place - middle) / std::max(0.1, glm::length(place - middle));
    glm::dquat rotation = turned(random.uniform(-0.1, 0.1), random.uniform(-0.1, 0.1));
    if (options.kind == Kind::roomPano) {
      rotation = turned(random.uniform(-kPi, kPi), random.uniform(-0.6, 0.6));
      if (v == 0) rotation = turned(0.3, kPi / 2);
      if (v == 1) rotation = turned(-0.2, -kPi / 2);
      if (v == 2) rotation = turned(kPi, 0);
    }
    const double fovY = options.kind == Kind::roomPano ? 1.2 : 0.8;
    views.push_back({fmt::format("truth{:02}.png", v), {pinholeFromFov(640, 400, fovY), {place, rotation}}, 0});
  }
  return views;
}

ExitCode synthesise(const Options& options, const Context& context) {
  if (options.kind == Kind::moving)
    return synthesiseMoving({options.output, options.frames, options.views, options.size}, context);
  if (options.kind == Kind::court)
    return synthesiseCourt({options.output, options.photographs, options.views, options.size}, context);
  if (options.kind == Kind::walk) return synthesiseWalk(options.walk, context);
  if (options.kind == Kind::noise) {
    NoiseOptions noise = options.noise;
    noise.output = options.output;
    return synthesiseNoise(noise, context);
  }
  const fs::path folder = options.output, truth = folder / "truth";
  const std::uint64_t seed = context.options().seed;
  const SyntheticOptions wanted = optionsOf(options, seed);
  const std::vector<View> views = truthViews(options, wanted.cameras, seed);
  std::size_t photographs = 0, cells = 0, triangles = 0;  // triangles: of one cell
  {
    ProgressLine progress(context);
    const std::size_t steps = wanted.cameras.size() + views.size() + 1;
    std::size_t done = 0;
    const auto step = [&] {
      check(progress.show({"generating the scene", done++, steps}), ErrorCode::cancelled, "stopped");
    };
    step();
    SyntheticScene made = makeScene(wanted);
    for (const Cell& cell : made.scene.cells) triangles += cell.mesh.triangles.size();
    for (std::size_t n = 0; n < made.scene.nodes.size(); ++n) {
      step();
      const Node& node = made.scene.nodes[n];
      for (const fs::path& file : {node.imageFile, node.textureFile})
        fs::create_directories((folder / file).parent_path());
      writeImage(folder / node.imageFile, made.photographs[n]);
      writeKtx2(folder / node.textureFile, encodeTexture(buildMips(made.photographs[n]), options.texture));
      if (options.kind == Kind::grid) break;  // all cells of a grid share the first one's mesh
    }
    if (options.kind == Kind::grid) {
      made.scene = gridScene(made.scene, options.side);
      writeCameraPath(folder / "walk.json", gridWalk(options.side, 640, 400));
    }
    photographs = made.scene.nodes.size();
    cells = made.scene.cells.size();
    fs::create_directories(truth / "images");
    for (const View& view : views) {
      step();
      writeImage(truth / "images" / view.name, renderTruth(made, view.camera, wanted.samplesPerAxis));
    }
    writeColmapViews(truth / "sparse", views);
    saveScene(made.scene, folder);
    progress.show({"generating the scene", steps, steps});
  }
  context.print("{}: {} photographs, {} of {} triangles; {} views in {}\n", options.output, photographs,
                cells == 1 ? "1 cell" : fmt::format("{} cells", cells), triangles, views.size(), truth.string());
  context.report(nlohmann::ordered_json{{"scene", options.output},
                                        {"truth", truth.string()},
                                        {"photographs", photographs},
                                        {"cells", cells},
                                        {"triangles", cells * triangles},
                                        {"views", views.size()}});
  return kExitOk;
}

}  // namespace

const Command kSynthCommand{
    .name = "synth",
    .summary = "Generates a synthetic scene with exact ground truth",
    .examples =
        "ibr-lab synth planes -o scene\n"
        "ibr-lab synth room-pano -o room --size 2048x1024\n"
        "ibr-lab synth grid -o grid --side 100 --size 512x512 --texture bc1\n"
        "ibr-lab synth moving -o figure --frames 25\n"
        "ibr-lab synth court -o court --photographs 300 && ibr build court/images -o scene\n"
        "ibr-lab synth walk -o walk --seconds 20\n"
        "ibr-lab synth noise --model colmap/sparse/0 --pixels 1 --track-pixels 0.5 -o noisy\n"
        "ibr eval room --truth room/truth -o compared",
    .details =
        "KIND is one of:\n"
        "  planes: a wall and two boards in front of the wall\n"
        "  room-pano: a room around panoramas\n"
        "  room-mixed: a room around panoramas and one pinhole\n"
        "  grid: any number of photographs of a wall at infinity, which share one texture file,\n"
        "    and a walk.json between the photographs\n"
        "  moving: a figure that bends and turns, photographed by eight cameras. Each frame is a\n"
        "    folder with mesh.ply (slightly inaccurate), mesh_exact.ply, images, masks, sparse and\n"
        "    truth, as input of `ibr htm build`\n"
        "  court: photographs to build a scene from, along a walk around a court, and their COLMAP\n"
        "    model with tracks. The distance between photographs does not depend on their number\n"
        "  walk: walk.mp4, the hand-held video of a walk through a hall. Its speed varies; it stops,\n"
        "    and turns on the spot. Jolts blur a quarter of the frames. transforms.json has the exact\n"
        "    pose of each frame; walk.json lists blurred frames, and times, smears and speeds of all\n"
        "    frames. Needs the program ffmpeg\n"
        "  noise: a COLMAP model with random pose errors, to measure ibr refine\n"
        "SCENE/truth gets views with their images, as input of ibr eval. Views are inside the\n"
        "cell, and every third view is slightly outside. The same seed gives the same scene.",
    .afterInterrupt = "some files may exist already; run the same command again",
    .declare = [](CLI::App& app) -> std::function<ExitCode(const Context&)> {
      const auto options = std::make_shared<Options>();
      addChoice<Kind>(app, "KIND", options->kind,
                      {{"planes", Kind::planes},
                       {"room-pano", Kind::roomPano},
                       {"room-mixed", Kind::roomMixed},
                       {"grid", Kind::grid},
                       {"moving", Kind::moving},
                       {"court", Kind::court},
                       {"walk", Kind::walk},
                       {"noise", Kind::noise}},
                      "Kind of scene to generate")
          .required();
      addOption(app, "-o,--output", options->output, "Scene folder; created if missing").required().type("SCENE");
      addInt(app, "--members", options->members, 2, 4, "Number of photographs, all of one cell");
      const Option views = addInt(app, "--views", options->views, 0, 10000, "Number of views in the truth; walk 20");
      addInt(app, "--frames", options->frames, 1, 10000, "moving: number of frames of one period");
      addInt(app, "--photographs", options->photographs, 2, 10000, "court: number of photographs along the walk");
      addInt(app, "--side", options->side, 2, 1000, "grid: number of photographs along each side");
      WalkVideoOptions& walk = options->walk;
      addDouble(app, "--seconds", walk.seconds, 0.1, 3600, "walk: duration of the video, s");
      addDouble(app, "--fps", walk.fps, 1, 240, "walk: frames a second");
      addDouble(app, "--shutter", walk.shutter, 1e-5, 1, "walk: exposure of a frame, s");
      addFlag(app, "--variable-rate", walk.variableRate, "walk: times between frames vary by a quarter");
      const Option model =
          addOption(app, "--model", options->noise.model, "noise: COLMAP model to add errors to").type("DIR");
      addDouble(app, "--pixels", options->noise.pixels, 0, 1000,
                "noise: root mean square shift of the image centre by rotation errors, px")
          .needs(model);
      addDouble(app, "--shift", options->noise.shift, 0, 1e9, "noise: root mean square error of positions, world units")
          .needs(model);
      addDouble(app, "--focal", options->noise.focalPercent, -50, 100, "noise: increase of all focal lengths, percent")
          .needs(model);
      addDouble(app, "--track-pixels", options->noise.trackPixels, 0, 1000,
                "noise: standard deviation of observations along each axis, px")
          .needs(model);
      addFlagCallback(
          app, "--no-tracks", [options] { options->noise.tracks = false; }, "noise: leave out the model's points")
          .needs(model);
      declareTextureFormat(app, options->texture);
      addSize(app, "--size", options->size,
              "Size of the photographs [640x480; panoramas 1024x512; moving 512x512; "
              "walk 640x360]");
      afterParsing(app, [options, views] {
        if (options->kind == Kind::walk) {
          if (views.isSet()) options->walk.views = options->views;
          options->walk.output = options->output;
          options->walk.size = options->size;
          checkWalkVideoOptions(options->walk);
        }
        if ((options->kind == Kind::noise) == options->noise.model.empty())
          refuseOption("--model",
                       options->noise.model.empty() ? "is required for KIND noise" : "is only valid for KIND noise");
      });
      return [options](const Context& context) { return synthesise(*options, context); };
    }};

}  // namespace ibr::app
