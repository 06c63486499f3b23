// SPDX-License-Identifier: Apache-2.0
#include "ibr/author/build.h"

#include "base/check.h"

namespace ibr {

std::filesystem::path posesFile(const BuildOptions& options) {
  std::filesystem::path found;
  for (const std::filesystem::path& file : {options.model, options.transforms, options.panoramas}) {
    check(found.empty() || file.empty(), ErrorCode::invalidInput,
          "poses are given twice, {} and {}: set only one of model, transforms and panoramas", found.string(),
          file.string());
    if (!file.empty()) found = file;
  }
  return found;
}

PosedModel readPoses(const BuildOptions& options, const LogCallback& log) {
  posesFile(options);
  if (!options.panoramas.empty()) return readPanoramas(options.panoramas);
  const Border border = options.keepBorder ? Border::keep : Border::crop;
  if (!options.transforms.empty()) return readTransforms(options.transforms, options.photographs, border);
  return readColmapModel(options.model, log, border);
}

}  // namespace ibr
