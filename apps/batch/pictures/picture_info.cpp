// SPDX-License-Identifier: Apache-2.0
#include "batch/pictures/picture_info.h"

#include <fmt/ranges.h>

#include <nlohmann/json.hpp>

#include "io/image_file.h"
#include "shared/camera/camera_json.h"
#include "shared/cli/setting_arguments.h"
#include "shared/draw/picture_record.h"

namespace ibr::app {

ExitCode showPicture(const std::filesystem::path& file, const Context& context) {
  using Json = nlohmann::ordered_json;
  const ImageFileInfo info = probeImage(file);
  const auto texts = readImageTexts(file);
  const auto record = readRecord(file);
  Json report{{"picture", file.string()},  {"size", {info.width, info.height}},
              {"channels", info.channels}, {"bitsPerChannel", info.bitsPerChannel},
              {"texts", Json::array()},    {"view", nullptr},
              {"settings", nullptr}};
  context.print("image        {}×{}, {} channels of {} bits\n", info.width, info.height, info.channels,
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
    context.print("rendered by  ibr render SCENE --poses {} {} -o DIR\n", file.string(),
                  fmt::join(settingArguments(record->settings), " "));
  } else {
    context.print("rendered by  unknown: no view is stored in this image\n");
  }
  context.report(report);
  return kExitOk;
}

}  // namespace ibr::app
