// SPDX-License-Identifier: Apache-2.0
#include "batch/inspect/advice_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "base/check.h"
#include "batch/files/colmap_views.h"
#include "shared/camera/camera_json.h"
#include "shared/camera/camera_path.h"

namespace ibr::app {
namespace {

constexpr std::size_t kMaxPerKind = 4;
constexpr double kMinUsefulGain =
    0.1;  // minimum gain of the best further view; below, further photographs are optional

std::string percent(double share) {
  return fmt::format("{:.0f} %", 100 * share);
}

const char* mark(Severity severity) {
  return severity == Severity::hint ? "-" : severity == Severity::warning ? "!" : "!!";
}

// Lists at most `most` sentences of each kind.
std::string sentencesText(const CaptureAdvice& advice, std::size_t most) {
  std::string text;
  std::map<AdviceKind, std::size_t> total, told;
  for (const Advice& one : advice.advice) ++total[one.kind];
  for (const Advice& one : advice.advice) {
    const std::size_t number = ++told[one.kind];
    if (number <= most)
      text += fmt::format("{} {}{}{}\n", mark(one.severity), one.problem, one.remedy.empty() ? "" : " ", one.remedy);
    if (number == most && total[one.kind] > most)
      text += fmt::format("  and {} more of this kind\n", total[one.kind] - most);
  }
  return text;
}

// Lists at most `most` next-best views.
std::string viewsText(const CaptureAdvice& advice, std::size_t most) {
  if (advice.views.empty()) return "";
  std::string text =
      fmt::format("on a walk between the photographs, about {} of an image is shown well; {} with these {}:\n",
                  percent(advice.coverage), percent(advice.coverageWithViews),
                  advice.views[0].gain < kMinUsefulGain ? "optional photographs" : "additional photographs");
  for (std::size_t v = 0; v < std::min(advice.views.size(), most); ++v)
    text += fmt::format("{:>3}  {}\n", v + 1, advice.views[v].where);
  return text;
}

}  // namespace

std::string adviceText(const CaptureAdvice& advice) {
  std::string text = sentencesText(advice, kMaxPerKind);
  if (text.empty()) text = "no problems found in these photographs\n";
  const std::string views = viewsText(advice, advice.views.size());
  return views.empty() ? text : text + '\n' + views;
}

std::string adviceSummary(const CaptureAdvice& advice, const std::string& scene) {
  constexpr std::size_t kShownViews = 3;
  std::string text = sentencesText(advice, 1) + viewsText(advice, kShownViews);
  if (advice.views.size() > kShownViews || text.find("more of this kind") != std::string::npos)
    text += fmt::format("ibr info {} --advice shows all\n", scene);
  return text;
}

nlohmann::ordered_json adviceJson(const Scene& scene, const CaptureAdvice& advice) {
  using Json = nlohmann::ordered_json;
  const auto names = [&](const std::vector<std::uint32_t>& nodes) {
    Json list = Json::array();
    for (const std::uint32_t n : nodes) list.push_back(scene.nodes[n].name);
    return list;
  };
  Json json{{"advice", Json::array()},
            {"shown", advice.coverage},
            {"shownWithNext", advice.coverageWithViews},
            {"next", Json::array()}};
  for (const Advice& one : advice.advice)
    json["advice"].push_back({{"kind", adviceKindName(one.kind)},
                              {"severity", severityName(one.severity)},
                              {"problem", one.problem},
                              {"remedy", one.remedy},
                              {"photographs", names(one.nodes)},
                              {"value", std::isfinite(one.value) ? Json(one.value) : Json(nullptr)}});
  for (const NextView& view : advice.views) {
    Json camera = intrinsicsJson(view.camera.intrinsics);
    addPose(camera, view.camera.pose);
    json["next"].push_back({{"description", view.where},
                            {"referencePhotographs", names(view.referenceNodes)},
                            {"gain", view.gain},
                            {"view", std::move(camera)}});
  }
  return json;
}

void writeNextViews(const std::filesystem::path& file, const CaptureAdvice& advice) {
  check(!advice.views.empty(), ErrorCode::invalidInput, "{}: no next-best views to write", file.string());
  std::vector<View> views;
  for (std::size_t v = 0; v < advice.views.size(); ++v) {
    const Camera& camera = advice.views[v].camera;
    check(camera.intrinsics.model == CameraModel::pinhole, ErrorCode::invalidInput,
          "{}: poses of panoramas cannot be written; --advice and --json list them", file.string());
    views.push_back({fmt::format("next_{:02}.png", v + 1), camera, double(v)});
  }
  if (file.extension() != ".json") {
    writeColmapViews(file, views);
    return;
  }
  const Intrinsics& first = views[0].camera.intrinsics;
  CameraPath path{first.width, first.height, 1, {}};
  for (const View& view : views) {
    const Intrinsics& k = view.camera.intrinsics;
    const double fovY = 2 * std::atan(0.5 * k.height / k.fy);
    path.keys.push_back({view.time, view.camera.pose.position, view.camera.pose.rotation, fovY});
  }
  writeCameraPath(file, path);
}

}  // namespace ibr::app
