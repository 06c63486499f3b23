// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "base/check.h"
#include "base/file.h"
#include "ibr/htm_sequence.h"
#include "scene/gltf_values.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

constexpr int kVersion = 1;
constexpr double kMaxFps = 1000;

HtmSequenceIndex indexOf(const JsonValue& root, const fs::path& folder) {
  checkVersion(root, {.newest = kVersion});
  HtmSequenceIndex index;
  index.fps = within(root["fps"], 0, kMaxFps);
  if (!(index.fps > 0)) root["fps"].fault("is not positive");
  const JsonValue frames = root["frames"];
  if (frames.size() == 0) frames.fault("is empty");
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const fs::path frame = frames.at(i).string();
    if (frame.empty()) frames.at(i).fault("is empty");
    try {
      pathInside(folder, frame);
    } catch (const Error& e) {
      frames.at(i).fault(e.what());
    }
    index.frames.push_back(frame);
  }
  return index;
}

HtmSequenceIndex readIndex(const fs::path& file) {
  const nlohmann::json document = parseJson(readTextFile(file));
  return indexOf(JsonValue(document), file.has_parent_path() ? file.parent_path() : fs::path("."));
}

}  // namespace

HtmSequenceIndex loadHtmSequence(const fs::path& path) {
  const fs::path file = documentFile(path, kHtmSequenceFileName);
  FaultSink sink(file, nullptr, 0);
  HtmSequenceIndex index;
  sink.run([&] { index = readIndex(file); });
  return index;
}

void saveHtmSequence(const HtmSequenceIndex& index, const fs::path& folder) {
  const std::string what = fmt::format("{}: sequence cannot be saved", folder.string());
  nlohmann::ordered_json document{{"version", kVersion}, {"fps", index.fps}};
  document["frames"] = nlohmann::ordered_json::array();
  for (const fs::path& frame : index.frames) document["frames"].push_back(frame.generic_string());
  std::string text;
  try {
    check(std::isfinite(index.fps), ErrorCode::invalidInput, "{}: fps is not finite", what);
    text = document.dump(1);
    const nlohmann::json again = parseJson(text);
    indexOf(JsonValue(again), folder);
  } catch (const JsonFault& fault) {
    fail(ErrorCode::invalidInput, "{}: {}: {}", what, fault.pointer(), fault.what());
  } catch (const nlohmann::json::exception&) {
    fail(ErrorCode::invalidInput, "{}: a frame's name is not UTF-8", what);
  }
  makeFolders(folder);
  writeFile(folder / kHtmSequenceFileName, text + '\n');
}

std::vector<Fault> validateHtmSequenceFiles(const fs::path& path, std::size_t limit) {
  const fs::path file = documentFile(path, kHtmSequenceFileName);
  std::vector<Fault> faults;
  FaultSink sink(file, &faults, limit);
  HtmSequenceIndex index;
  if (!sink.run([&] { index = readIndex(file); })) return faults;
  for (std::size_t i = 0; i < index.frames.size() && !sink.full(); ++i)
    for (const Fault& fault : validateHtmModelFiles(file.parent_path() / index.frames[i], limit - faults.size()))
      sink.add(fmt::format("/frames/{}", i), fmt::format("{}: {}{}{}", index.frames[i].string(), fault.field,
                                                         fault.field.empty() ? "" : ": ", fault.message));
  return faults;
}

}  // namespace ibr
