// SPDX-License-Identifier: Apache-2.0
// Scene files with one fault at a time. Each time loadScene must throw an Error that names file and JSON pointer, and
// validateSceneFiles must report the fault. No other outcome is allowed.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "ibr/error.h"
#include "support/json.h"
#include "support/temporary_folder.h"

namespace ibr::test {

using Json = nlohmann::json;

inline const std::string kExtension = "/extensions/IBR_image_graph";

/// A valid scene on disk, and its document.
struct Example {
  TemporaryFolder folder;
  Json document;
  Example();
  void write(const Json& json) const;
  void restore() const { write(document); }
  std::filesystem::path bufferOf(std::size_t cell) const;
};

/// Created once. Tests restore the example after changes.
Example& example();

struct Refusal {
  ErrorCode code;
  std::string message;
};

/// Returns the Error of loadScene. If `place` (a JSON pointer) is given, validateSceneFiles must report the place, too.
Refusal refusal(const std::filesystem::path& path, const std::string& place = {});

/// Replaces the example's value at `pointer` with a piece of JSON text, and expects a refusal at `pointer`, or at
/// `place` if given.
void refuse(const std::string& pointer, const std::string& text, std::string place = {});

/// Removes the member at `pointer` and expects a refusal that names the containing object.
void refuseWithout(const std::string& pointer);

}  // namespace ibr::test
