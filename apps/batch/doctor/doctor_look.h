// SPDX-License-Identifier: Apache-2.0
// What `ibr doctor` knows of a photograph once it has read it.
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
  std::string trouble;                       // why it cannot be read; then the rest is not known, and …
  ErrorCode code = ErrorCode::invalidInput;  // … of which kind that is
  ImageFileInfo info;
  double sharpness = std::numeric_limits<double>::quiet_NaN();  // image/sharpness.h
  std::uint64_t hash = 0;                                       // of the file's bytes
  std::vector<float> signature;  // of 16×16 greys, of mean 0 and length 1; empty for a picture of one grey
};

/// −1 to 1: how alike two photographs look, whatever their brightness and contrast; 0 where one is of one grey.
double alikeness(const ExaminedPhotograph& a, const ExaminedPhotograph& b);

/// Reads them all, with the threads that memory allows for the largest of them. Throws Error{cancelled}.
std::vector<ExaminedPhotograph> lookAtAll(const std::filesystem::path& folder, const std::vector<std::string>& names,
                                          const Context& context);

}  // namespace ibr::app
