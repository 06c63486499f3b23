// SPDX-License-Identifier: Apache-2.0
// Recognises a file or folder of poses by its content, and reads it.
#include <algorithm>
#include <array>
#include <string_view>

#include "author/poses/pose_source.h"
#include "base/check.h"
#include "base/file.h"
#include "ibr/author/build.h"
#include "ibr/author/poses.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

struct Format {
  PoseFormat format;
  const char* name;
  bool (*recognises)(const PoseSource& source);
  PosedModel (*read)(PoseSource& source);
};

bool isColmapFolder(const PoseSource& source) {
  for (const char* extension : {".bin", ".txt"})
    if (fs::exists(source.path / (std::string("cameras") + extension)) &&
        fs::exists(source.path / (std::string("images") + extension)))
      return true;
  return false;
}

bool hasKey(const nlohmann::json& json, const char* key) {
  return json.is_object() && json.contains(key);
}

bool isOpenSfm(const PoseSource& source) {
  return source.json.is_array() && !source.json.empty() && hasKey(source.json[0], "shots") &&
         hasKey(source.json[0], "cameras");
}

const std::array kFormats{
    Format{PoseFormat::colmap, "COLMAP model", isColmapFolder,
           [](PoseSource& source) { return readColmapModel(source.path, source.log, source.border); }},
    Format{PoseFormat::transforms, "transforms.json",
           [](const PoseSource& source) { return hasKey(source.json, "frames"); }, readTransforms},
    Format{PoseFormat::panoramas, "panoramas.json",
           [](const PoseSource& source) { return hasKey(source.json, "panoramas"); }, readPanoramas},
    Format{PoseFormat::bundler, "bundle.out",
           [](const PoseSource& source) { return source.text.starts_with("# Bundle file"); }, readBundler},
    Format{PoseFormat::nvm, "NVM_V3", [](const PoseSource& source) { return source.text.starts_with("NVM_V3"); },
           readNvm},
    Format{PoseFormat::openMvg, "sfm_data.json",
           [](const PoseSource& source) { return hasKey(source.json, "sfm_data_version"); }, readOpenMvg},
    Format{PoseFormat::openSfm, "reconstruction.json", isOpenSfm, readOpenSfm},
    Format{PoseFormat::metashape, "Metashape XML", isMetashape, readMetashape},
    Format{PoseFormat::realityCsv, "RealityScan CSV", isRealityCsv, readRealityCsv},
    Format{PoseFormat::realityXmp, "RealityScan XMP folder", isRealityXmp, readRealityXmp},
};

std::string_view start(std::string_view text) {
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first == text.npos ? std::string_view() : text.substr(first);
}

[[noreturn]] void failAt(const fs::path& file, const JsonFault& fault) {
  fail(ErrorCode::invalidInput, "{}: {}{}{}", file.string(), fault.pointer(), fault.pointer().empty() ? "" : ": ",
       fault.what());
}

void checkNoneMissing(const PoseSource& source, std::size_t images) {
  constexpr std::size_t kMaxListed = 5;
  const std::vector<std::string>& missing = source.missing;
  std::string names;
  for (std::size_t i = 0; i < std::min(missing.size(), kMaxListed); ++i) names += (i > 0 ? ", " : "") + missing[i];
  if (missing.size() > kMaxListed) names += fmt::format(" and {} more", missing.size() - kMaxListed);
  check(missing.empty(), ErrorCode::io,
        "{}: {} of the {} photographs are missing in {}: {}. This format holds no image sizes, so that all photographs "
        "are needed",
        source.path.string(), missing.size(), images, source.photographs.folder().string(), names);
}

PoseSource open(const fs::path& path, const fs::path& photographs, const LogCallback& log, Border border) {
  PoseSource source{path, {}, {}, PhotographFinder(photographs), log, border, {}};
  if (fs::is_directory(path)) return source;
  source.text = readTextFile(path);
  const std::string_view content = start(source.text);
  if (!content.starts_with('{') && !content.starts_with('[')) return source;
  try {
    source.json = parseJson(content);
  } catch (const JsonFault& fault) {
    failAt(path, fault);
  }
  return source;
}

const Format* formatOf(const PoseSource& source) {
  for (const Format& format : kFormats)
    if (format.recognises(source)) return &format;
  return nullptr;
}

}  // namespace

const char* poseFormatName(PoseFormat format) {
  return kFormats[std::size_t(format)].name;
}

std::optional<PoseFormat> poseFormatOf(const fs::path& path) {
  try {
    const Format* format = formatOf(open(path, {}, {}, Border::crop));
    return format ? std::optional(format->format) : std::nullopt;
  } catch (const Error& error) {
    if (error.code() == ErrorCode::io) throw;
    return std::nullopt;
  }
}

PosedModel readPoseFile(const fs::path& path, const fs::path& photographs, const LogCallback& log, Border border) {
  PoseSource source = open(path, photographs, log, border);
  const Format* format = formatOf(source);
  if (!format && fs::is_directory(path))
    fail(ErrorCode::io,
         "{}: holds neither cameras.bin and images.bin, nor cameras.txt and images.txt, nor XMP files of RealityScan",
         path.string());
  std::string known;
  for (const Format& one : kFormats) known += (known.empty() ? "" : ", ") + std::string(one.name);
  check(format, ErrorCode::invalidInput, "{}: the content is in no known format of poses ({})", path.string(), known);
  try {
    PosedModel model = format->read(source);
    checkNoneMissing(source, model.images.size());
    nameAndSort(model, path, source.photographs, format->format == PoseFormat::colmap);
    return model;
  } catch (const JsonFault& fault) {
    failAt(path, fault);
  } catch (const PoseFault& fault) {
    fail(fault.code(), "{}: {}: {}", path.string(), fault.at(), fault.what());
  }
}

PosedModel readTransforms(const fs::path& file, const fs::path& photographs, Border border) {
  PoseSource source = open(file, photographs, {}, border);
  try {
    PosedModel model = readTransforms(source);
    nameAndSort(model, file, source.photographs);
    return model;
  } catch (const JsonFault& fault) {
    failAt(file, fault);
  }
}

PosedModel readPanoramas(const fs::path& file) {
  PoseSource source = open(file, {}, {}, Border::crop);
  try {
    PosedModel model = readPanoramas(source);
    nameAndSort(model, file, source.photographs);
    return model;
  } catch (const JsonFault& fault) {
    failAt(file, fault);
  }
}

PosedModel readPoses(const BuildOptions& options, const LogCallback& log) {
  return readPoseFile(options.model, options.photographs, log, options.keepBorder ? Border::keep : Border::crop);
}

}  // namespace ibr
