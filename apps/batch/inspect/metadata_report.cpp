// SPDX-License-Identifier: Apache-2.0
#include "batch/inspect/metadata_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <filesystem>
#include <map>
#include <vector>

#include "ibr/error.h"
#include "io/metadata.h"

namespace fs = std::filesystem;

namespace ibr::app {

MetadataReport metadataReport(const Scene& scene) {
  std::map<std::string, std::size_t> kinds;
  std::size_t captures = 0;
  for (const Node& node : scene.nodes) {
    captures += node.capture != CaptureMetadata();
    try {
      for (const std::string& kind : metadataKinds(scene.folder / node.imageFile)) ++kinds[kind];
    } catch (const Error&) {  // a missing photograph is reported by `validate`
    }
  }
  std::vector<std::string> parts;
  for (const auto& [kind, count] : kinds) parts.push_back(fmt::format("{} in {} photographs", kind, count));
  if (captures > 0) parts.push_back(fmt::format("camera settings of {} photographs in scene.gltf", captures));
  std::vector<std::string> folders;
  for (const char* name : {".photographs", ".poses", ".refined", ".build"}) {
    std::error_code ignored;
    if (fs::is_directory(scene.folder / name, ignored)) folders.emplace_back(name);
  }
  MetadataReport report;
  report.json = {{"kinds", kinds}, {"captureMetadata", captures}, {"workingFolders", folders}};
  report.text = fmt::format("metadata     {}\n", parts.empty() ? "none but the names of the photographs"
                                                               : fmt::format("{}", fmt::join(parts, "; ")));
  if (!folders.empty())
    report.text +=
        fmt::format("             working folders may hold copies, and can be deleted: {}\n", fmt::join(folders, ", "));
  return report;
}

}  // namespace ibr::app
