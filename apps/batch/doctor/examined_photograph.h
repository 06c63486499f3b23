// SPDX-License-Identifier: Apache-2.0
// Data that `ibr doctor` reads from a photograph.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <string>
#include <vector>

#include "ibr/error.h"
#include "io/image_file.h"
#include "shared/cli/context.h"

namespace ibr::app {

struct ExaminedPhotograph {
  std::string name;
  std::string readError;                     // reason why the file is unreadable; other fields are then unset
  ErrorCode code = ErrorCode::invalidInput;  // error code of `readError`
  ImageFileInfo info;
  double sharpness = std::numeric_limits<double>::quiet_NaN();  // ibr/metrics.h
  std::uint64_t hash = 0;                                       // of the file's bytes
  std::vector<float> signature;  // 16×16 grey levels, of mean 0 and length 1; empty for a uniform image
};

/// Returns the correlation of two signatures, −1 to 1, independent of brightness and contrast; 0 for uniform images.
double signatureCorrelation(const ExaminedPhotograph& a, const ExaminedPhotograph& b);

/// Reads all photographs, with as many threads as memory allows for the largest one. Throws Error{cancelled}.
std::vector<ExaminedPhotograph> examineAll(const std::filesystem::path& folder, const std::vector<std::string>& names,
                                           const Context& context);

}  // namespace ibr::app
