// SPDX-License-Identifier: Apache-2.0
// Writes photographs of a synthetic court and their COLMAP model into a folder, as input of a build.
#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <filesystem>
#include <optional>

#include "ibr/author/build.h"
#include "io/image_file.h"
#include "lab/generate/court.h"
#include "support/temporary_folder.h"

namespace ibr::test {

struct CourtPhotographs {
  /// Photographs are named photo00.jpg, photo01.jpg, …; `larger`: index of one stored at twice its camera's size.
  explicit CourtPhotographs(const Court& court, std::optional<std::size_t> larger = {}) {
    PosedModel model;
    std::filesystem::create_directories(folder / "photos");
    for (std::size_t i = 0; i < court.cameras.size(); ++i) {
      model.images.push_back({fmt::format("photo{:02}.jpg", i), court.cameras[i]});
      Camera taken = court.cameras[i];
      if (i == larger)
        taken.intrinsics = resized(taken.intrinsics, 2 * taken.intrinsics.width, 2 * taken.intrinsics.height);
      writeImage(folder / "photos" / model.images[i].name, photograph(court, taken, 1), 95);
    }
    for (const CourtTrack& track : tracksOf(court, 1)) {
      Track& added = model.tracks.emplace_back(Track{track.position, {}});
      for (const auto& [camera, pixel] : track.seen) added.observations.push_back({camera, pixel});
    }
    writeColmapModel(model, folder / "model");
    options.photographs = folder / "photos";
    options.model = folder / "model";
    options.output = folder / "scene";
    options.tracks = TrackSource::model;
  }

  TemporaryFolder folder;
  BuildOptions options;
};

}  // namespace ibr::test
