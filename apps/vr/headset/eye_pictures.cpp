// SPDX-License-Identifier: Apache-2.0
#include "vr/headset/eye_pictures.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "shared/draw/picture_record.h"

namespace fs = std::filesystem;

namespace ibr::app {
namespace {

fs::path eyeFile(const fs::path& file, char eye) {
  return file.parent_path() / fmt::format("{}_{}.png", file.stem().string(), eye);
}

}  // namespace

fs::path freePicture(const fs::path& folder) {
  for (int number = 1;; ++number) {
    const fs::path file = folder / fmt::format("view_{:04d}.png", number);
    if (!fs::exists(eyeFile(file, 'l')) && !fs::exists(eyeFile(file, 'r')) && !fs::exists(file)) return file;
  }
}

std::array<fs::path, 2> writeEyes(const fs::path& file, const std::array<Image8, 2>& pictures,
                                  const std::array<Camera, 2>& eyes, nlohmann::ordered_json settings) {
  if (file.has_parent_path()) makeFolders(file.parent_path());
  settings["graph"] = false;
  const std::array<fs::path, 2> files{eyeFile(file, 'l'), eyeFile(file, 'r')};
  for (std::size_t eye = 0; eye < 2; ++eye)
    writePicture(files[eye], pictures[eye], {eyes[eye], std::nullopt, settings});
  return files;
}

}  // namespace ibr::app
