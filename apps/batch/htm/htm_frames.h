// SPDX-License-Identifier: Apache-2.0
// Frames of a 3D video as they were photographed, and the harmonised models that they become.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "ibr/htm_author.h"

namespace ibr::app {

struct HtmFrameInput {
  std::string name;             // of its folder
  std::filesystem::path mesh;   // mesh.ply, .obj, .gltf or .glb
  std::filesystem::path model;  // sparse, or sparse/0
  std::filesystem::path images;
  std::filesystem::path masks;  // or empty
};

/// Every folder in `folder` but hidden ones, sorted by name. Throws Error that names the first folder or file that is
/// missing: io; invalidInput where there is no frame at all, or a frame has several meshes.
std::vector<HtmFrameInput> findHtmFrames(const std::filesystem::path& folder);

struct HtmFrameModel {
  bool kept = false;              // it was there
  double seconds = 0;             // that making it took
  nlohmann::ordered_json report;  // htmReportJson
};

/// The model of a frame in SEQUENCE/NAME where it is whole and was made by the same program from the same files with
/// the same options; else nullopt. `options` without its paths.
std::optional<HtmFrameModel> keptHtmFrame(const HtmFrameInput& frame, const HtmBuildOptions& options,
                                          const std::filesystem::path& sequence);

/// Makes SEQUENCE/NAME, in another folder until it is whole. What of an earlier model was there is replaced. Throws
/// what buildHtm throws, with the frame's name before it, Error{invalidInput} where SEQUENCE/NAME is something else
/// than a model; then what was there before is as it was.
HtmFrameModel buildHtmFrame(const HtmFrameInput& frame, const HtmBuildOptions& options,
                            const std::filesystem::path& sequence, const ProgressCallback& progress,
                            const LogCallback& log);

}  // namespace ibr::app
