// SPDX-License-Identifier: Apache-2.0
// Photographed frames of a 3D video, and the harmonised models built from them.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "ibr/author/htm.h"

namespace ibr::app {

struct HtmFrameInput {
  std::string name;             // of the frame's folder
  std::filesystem::path mesh;   // mesh.ply, .obj, .gltf or .glb
  std::filesystem::path model;  // sparse, or sparse/0
  std::filesystem::path images;
  std::filesystem::path masks;  // may be empty
};

/// Returns every folder in `folder` except hidden ones, sorted by name. Throws Error that names the first missing
/// folder or file: io; invalidInput if there is no frame, or a frame has several meshes.
std::vector<HtmFrameInput> findHtmFrames(const std::filesystem::path& folder);

struct HtmFrameModel {
  bool kept = false;              // true: cached
  double seconds = 0;             // build time, s; 0 if cached
  nlohmann::ordered_json report;  // htmReportJson
};

/// Returns the cached model in SEQUENCE/NAME if it is complete and was built by the same program from the same files
/// with the same options; else nullopt. `options` without its paths.
std::optional<HtmFrameModel> cachedHtmFrame(const HtmFrameInput& frame, const HtmBuildOptions& options,
                                            const std::filesystem::path& sequence);

/// Builds SEQUENCE/NAME in a temporary folder first. Replaces an earlier model. Throws the errors of buildHtm with the
/// frame's name in front, and Error{invalidInput} if SEQUENCE/NAME is not a model. After an error the earlier
/// content is unchanged.
HtmFrameModel buildHtmFrame(const HtmFrameInput& frame, const HtmBuildOptions& options,
                            const std::filesystem::path& sequence, const ProgressCallback& progress,
                            const LogCallback& log);

}  // namespace ibr::app
