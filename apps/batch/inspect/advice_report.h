// SPDX-License-Identifier: Apache-2.0
// Advice on a capture, for people, for scripts, and as poses.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "ibr/advice.h"

namespace ibr::app {

/// Sentences, of each kind the worst few, then the photographs to take, numbered as graphSvg numbers them.
std::string adviceText(const CaptureAdvice& advice);

/// {"advice": [{"kind", "severity", "sentence", "remedy", "photographs", "figure"}], "shown", "shownThen",
///  "next": [{"where", "beside", "gain", "view"}]}; "view" as `ibr info PICTURE` has it.
nlohmann::ordered_json adviceJson(const Scene& scene, const CaptureAdvice& advice);

/// The photographs to take, next_01 and so on: a camera path where the name ends in .json, else a COLMAP model in a
/// folder; both are for `ibr render --poses`, and the first for ibr-viewer. Throws Error (io; invalidInput where there
/// is none, or one is a panorama).
void writeNextViews(const std::filesystem::path& file, const CaptureAdvice& advice);

}  // namespace ibr::app
