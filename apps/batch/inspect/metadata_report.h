// SPDX-License-Identifier: Apache-2.0
// What a scene's files tell beyond the place that they show.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "ibr/scene.h"

namespace ibr::app {

/// Metadata of the stored photographs by kind (io/metadata.h), capture metadata in scene.gltf, names of photographs,
/// and working folders, which hold copies.
struct MetadataReport {
  std::string text;  // lines for people
  nlohmann::ordered_json json;
};
MetadataReport metadataReport(const Scene& scene);

}  // namespace ibr::app
