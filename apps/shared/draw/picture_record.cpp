// SPDX-License-Identifier: Apache-2.0
#include "shared/draw/picture_record.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "ibr/version.h"
#include "io/image_file.h"
#include "shared/camera/camera_json.h"

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kKey = "ibr";
constexpr int kVersion = 1;
constexpr double kMaxTimeSeconds = 1e9;  // limit of "time", s

}  // namespace

void writePicture(const std::filesystem::path& file, const Image8& image, const PictureRecord& record) {
  Json view;
  addPose(view, record.camera.pose);
  view["intrinsics"] = intrinsicsJson(record.camera.intrinsics);
  if (record.time) view["time"] = *record.time;
  const Json json{{"version", kVersion}, {"libibr", ibr::version()}, {"view", view}, {"settings", record.settings}};
  writeImage(file, image, {{kKey, json.dump(-1, ' ', true, Json::error_handler_t::replace)}});
}

std::optional<PictureRecord> readRecord(const std::filesystem::path& file) {
  const auto texts = readImageTexts(file);
  const auto found = std::ranges::find(texts, kKey, &ImageText::key);
  if (found == texts.end()) return std::nullopt;
  const std::string name = file.string();
  const Json json = parseJson(found->text, name);
  const JsonField root = JsonField::whole(json, name);
  root.at("version").integer(kVersion, kVersion);
  const JsonField view = root.at("view");
  PictureRecord record;
  record.camera = {intrinsicsOf(view.at("intrinsics")), poseOf(view)};
  if (view.has("time")) record.time = view.at("time").number(-kMaxTimeSeconds, kMaxTimeSeconds);
  const JsonField settings = root.at("settings");
  settings.wanted(settings.json().is_object(), "an object");
  record.settings = settings.json();
  return record;
}

}  // namespace ibr::app
