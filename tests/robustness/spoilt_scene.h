// SPDX-License-Identifier: Apache-2.0
// NUMERICS §7.1 for scene files: a good scene, spoilt in one place at a time. Each time loadScene throws an Error that
// names file and place, and validateSceneFiles reports it; nothing else ever happens.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "ibr/error.h"
#include "support/temporary_folder.h"

namespace ibr::test {

using Json = nlohmann::json;

inline const std::string kExtension = "/extensions/IBR_image_graph";

/// A good scene on disk, and its document.
struct Example {
  TemporaryFolder folder;
  Json document;
  Example();
  void write(const Json& json) const;
  void restore() const { write(document); }
  std::filesystem::path bufferOf(std::size_t cell) const;
};

/// Made once; tests leave it as it was.
Example& example();

struct Refusal {
  ErrorCode code;
  std::string message;
};

/// What loadScene says. validateSceneFiles must find fault with `place` (a JSON pointer) too, where one is given.
Refusal refusal(const std::filesystem::path& path, const std::string& place = {});

/// Writes the example with the value at `pointer` replaced by a piece of JSON text, and expects it to be refused there
/// (or at `place`).
void refuse(const std::string& pointer, const std::string& text, std::string place = {});

/// The same without the member at `pointer`; the place is what should hold it.
void refuseWithout(const std::string& pointer);

}  // namespace ibr::test
