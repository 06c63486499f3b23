// SPDX-License-Identifier: Apache-2.0
#include "batch/picture_info.h"

#include <cctype>
#include <nlohmann/json.hpp>

#include "io/image_file.h"
#include "shared/camera_json.h"
#include "shared/picture_record.h"

namespace ibr::app {
namespace {

using Json = nlohmann::ordered_json;

// "textureScale" → "--texture-scale".
std::string optionOf(const std::string& key) {
  std::string option = "--";
  for (const char c : key)
    if (std::isupper(static_cast<unsigned char>(c)))
      option += {'-', char(std::tolower(static_cast<unsigned char>(c)))};
    else
      option += c;
  return option;
}

// As they are typed: null and false are what is not given.
std::string wordsOf(const Json& settings) {
  std::string words;
  for (const auto& [key, value] : settings.items()) {
    if (value.is_null() || value == false) continue;
    words += ' ' + optionOf(key);
    if (value != true) words += ' ' + (value.is_string() ? value.get<std::string>() : value.dump());
  }
  return words;
}

}  // namespace

ExitCode showPicture(const std::filesystem::path& file, const Context& context) {
  const ImageFileInfo info = probeImage(file);
  const auto texts = readImageTexts(file);
  const auto record = readRecord(file);
  Json report{{"picture", file.string()},  {"size", {info.width, info.height}},
              {"channels", info.channels}, {"bitsPerChannel", info.bitsPerChannel},
              {"texts", Json::array()},    {"view", nullptr},
              {"settings", nullptr}};
  context.print("picture      {}×{}, {} channels of {} bits\n", info.width, info.height, info.channels,
                info.bitsPerChannel);
  for (const auto& [key, text] : texts) {
    context.print("text         {}: {}\n", key, text);
    report["texts"].push_back({{"key", key}, {"text", text}});
  }
  if (record) {
    report["view"] = intrinsicsJson(record->camera.intrinsics);
    addPose(report["view"], record->camera.pose);
    if (record->time) report["view"]["time"] = *record->time;
    report["settings"] = record->settings;
    context.print("drawn by     ibr render SCENE --poses {}{} -o DIR\n", file.string(), wordsOf(record->settings));
  } else {
    context.print("drawn by     unknown: no view stands in this picture\n");
  }
  context.report(report.dump(2, ' ', false, Json::error_handler_t::replace));
  return kExitOk;
}

}  // namespace ibr::app
