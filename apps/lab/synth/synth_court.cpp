// SPDX-License-Identifier: Apache-2.0
#include "lab/synth/synth_court.h"

#include <nlohmann/json.hpp>

#include "base/check.h"
#include "base/file.h"
#include "base/parallel.h"
#include "batch/files/colmap_views.h"
#include "ibr/author/poses.h"
#include "io/image_file.h"
#include "lab/generate/court.h"
#include "shared/cli/progress.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

PosedModel modelOf(const Court& court, const std::vector<View>& photographs, std::uint64_t seed) {
  PosedModel model;
  for (const View& view : photographs) model.images.push_back({view.name, view.camera});
  for (const CourtTrack& track : tracksOf(court, seed)) {
    Track& added = model.tracks.emplace_back(Track{track.position, {}});
    for (const auto& [camera, pixel] : track.seen) added.observations.push_back({camera, pixel});
  }
  return model;
}

}  // namespace

ExitCode synthesiseCourt(const CourtOptions& options, const Context& context) {
  const PictureSize size = options.size.width == 0 ? PictureSize{640, 480} : options.size;
  const fs::path folder = options.output, truth = folder / "truth";
  const std::uint64_t seed = context.options().seed;
  const Court court = makeCourt(options.photographs, size.width, size.height, seed);
  std::vector<View> photographs, views;
  for (std::size_t i = 0; i < court.cameras.size(); ++i)
    photographs.push_back({fmt::format("photo{:04}.jpg", i), court.cameras[i], 0});
  for (int v = 0; v < options.views; ++v)
    views.push_back({fmt::format("truth{:02}.png", v), cameraInCourt(court, (v + 0.37) / options.views), 0});
  const PosedModel model = modelOf(court, photographs, seed);
  makeFolders(folder / "images");
  makeFolders(truth / "images");
  {
    ProgressLine progress(context);
    const std::size_t count = photographs.size() + views.size();
    // In a large image, pixels are small compared to the textures' waves, so one sample a pixel is enough.
    const int samples = size.width >= 2000 ? 1 : 2;
    const auto take = [&](std::size_t i) {
      const bool first = i < photographs.size();
      const View& view = first ? photographs[i] : views[i - photographs.size()];
      writeImage((first ? folder : truth) / "images" / view.name, photograph(court, view.camera, samples));
    };
    check(runJobs(count, threadsFor(context.options().threads, 10.0 * size.width * size.height), take,
                  [&](std::size_t done) {
                    return progress.show({"rendering the court", done, count});
                  }),
          ErrorCode::cancelled, "stopped");
  }
  writeColmapModel(model, folder / "sparse");
  writeColmapViews(truth / "sparse", views);
  context.print("{}: {} photographs, {} tracks; {} views in {}\n", options.output, photographs.size(),
                model.tracks.size(), views.size(), truth.string());
  context.report(nlohmann::ordered_json{{"folder", options.output},
                                        {"truth", truth.string()},
                                        {"photographs", photographs.size()},
                                        {"tracks", model.tracks.size()},
                                        {"views", views.size()}});
  return kExitOk;
}

}  // namespace ibr::app
