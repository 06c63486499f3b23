// SPDX-License-Identifier: Apache-2.0
// Advice on a capture: as text, as JSON, and as poses.
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "ibr/advice.h"

namespace ibr::app {

/// Returns the worst few sentences of each kind, then the next-best views, numbered as in graphSvg.
std::string adviceText(const CaptureAdvice& advice);

/// Returns the worst sentence of each kind and the first three next-best views; `scene`: as for `ibr info --advice`.
std::string adviceSummary(const CaptureAdvice& advice, const std::string& scene);

/// {"advice": [{"kind", "severity", "problem", "remedy", "photographs", "value"}], "shown", "shownWithNext",
///  "next": [{"description", "referencePhotographs", "gain", "view"}]}; "view" as in the report of `ibr info PICTURE`.
nlohmann::ordered_json adviceJson(const Scene& scene, const CaptureAdvice& advice);

/// Writes the next-best views next_01 and so on: as a camera path if the name ends in .json, else as a COLMAP model in
/// a folder. `ibr render --poses` reads both, ibr-viewer the path. Throws Error (io; invalidInput if there are none, or
/// one is a panorama).
void writeNextViews(const std::filesystem::path& file, const CaptureAdvice& advice);

}  // namespace ibr::app
