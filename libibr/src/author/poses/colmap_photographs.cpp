// SPDX-License-Identifier: Apache-2.0
#include "author/poses/colmap_photographs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include "author/photographs/masks.h"
#include "author/photographs/photographs.h"
#include "base/check.h"
#include "base/file.h"
#include "base/hash.h"
#include "base/parallel.h"
#include "ibr/author/photographs.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

constexpr std::uint64_t kVersion = 3;  // version of the steps: raise it when their results change
constexpr double kBytesPerPixel = 14;  // memory for reading and rotating a photograph
constexpr const char* kCheckingStage = "checking photographs";

// False if `folder` is an empty path.
bool isWithin(const fs::path& file, const fs::path& folder) {
  if (folder.empty()) return false;
  const fs::path inside = fs::weakly_canonical(file).lexically_relative(fs::weakly_canonical(folder));
  return !inside.empty() && *inside.begin() != "..";
}

template <class F>
void collectFault(std::string& fault, F&& read) {
  try {
    read();
  } catch (const Error& error) {
    if (!isFileError(error)) throw;
    fault = error.what();
  }
}

std::optional<fs::path> maskOf(const PoseOptions& options, const std::string& name) {
  return options.masks.empty() ? std::nullopt : findMaskFile(options.masks, name);
}

bool isRotated(const PoseOptions& options, const ImageFileInfo& info) {
  return options.orientation != Orientation::stored && info.orientation != 1;
}

// COLMAP reads neither rotated photographs upright nor the formats of ibr-decode.
bool isCopied(const PoseOptions& options, const ImageFileInfo& info) {
  const bool colmapReads =
      info.format == ImageFormat::jpeg || info.format == ImageFormat::png || info.format == ImageFormat::tiff;
  return isRotated(options, info) || !colmapReads;
}

bool anyCopied(const PoseOptions& options, const ColmapPhotographs& photographs) {
  return std::ranges::any_of(photographs.infos, [&](const ImageFileInfo& info) { return isCopied(options, info); });
}

std::pair<int, int> uprightSize(const PoseOptions& options, const ImageFileInfo& info) {
  const bool swaps = isRotated(options, info) && info.orientation >= 5;
  return swaps ? std::pair(info.height, info.width) : std::pair(info.width, info.height);
}

// Writes a JPEG below `folder`, or a link to a photograph that COLMAP reads as it is, after decoding it.
void placeUpright(const PoseOptions& options, const std::string& name, const ImageFileInfo& info,
                  const fs::path& folder) {
  const fs::path from = options.photographs / name, to = folder / name;
  makeFolders(to.parent_path());
  if (isCopied(options, info)) return writeJpegCopy(from, to, isRotated(options, info));
  readImage(from);
  fs::remove(to);
  fs::create_symlink(fs::absolute(from), to);
}

}  // namespace

ColmapPhotographs colmapPhotographs(const PoseOptions& options) {
  ColmapPhotographs result{scanPhotographFolder(options.photographs).pictures, {}};
  std::erase_if(result.names, [&](const std::string& name) {
    return isWithin(options.photographs / name, options.excludedFolder) ||
           std::ranges::find(options.exclude, name) != options.exclude.end();
  });
  checkEnoughForPoses(options.photographs, result.names.size());
  std::vector<std::string> faults(result.names.size());
  result.infos.resize(result.names.size());
  for (std::size_t i = 0; i < result.names.size(); ++i)
    collectFault(faults[i], [&] { result.infos[i] = probeImage(options.photographs / result.names[i]); });
  checkReadable(std::move(faults));
  return result;
}

std::vector<std::string> colmapKeyLines(const PoseOptions& options, const ColmapPhotographs& photographs) {
  std::vector<std::string> lines{
      fmt::format("{} {}", kVersion, options.orientation == Orientation::stored ? "stored" : "upright")};
  for (const std::string& name : photographs.names) {
    const fs::path file = options.photographs / name;
    Hash hash;
    hash.add(std::uint64_t(fs::file_size(file)));
    hash.add(std::int64_t(fs::last_write_time(file).time_since_epoch().count()));
    if (const auto mask = maskOf(options, name)) hash.add(readFile(*mask));
    lines.push_back(fmt::format("{:016x} {}", hash.value(), name));
  }
  return lines;
}

fs::path colmapImageFolder(const PoseOptions& options, const ColmapPhotographs& photographs) {
  return anyCopied(options, photographs) ? options.folder / "upright" : options.photographs;
}

void checkColmapPhotographs(const PoseOptions& options, const ColmapPhotographs& photographs,
                            std::span<const std::size_t> indices, const ProgressCallback& progress) {
  double most = 0;
  for (const ImageFileInfo& info : photographs.infos) most = std::max(most, double(info.width) * info.height);
  const bool copies = anyCopied(options, photographs);
  std::vector<std::string> faults(indices.size());
  const bool finished = runJobs(
      indices.size(), threadsFor(options.threads, kBytesPerPixel * most),
      [&](std::size_t job) {
        const std::size_t i = indices[job];
        collectFault(faults[job], [&] {
          if (copies)
            placeUpright(options, photographs.names[i], photographs.infos[i], options.folder / "upright");
          else
            readImage(options.photographs / photographs.names[i]);
        });
      },
      [&](std::size_t done) {
        return !progress || progress({kCheckingStage, done, indices.size()});
      });
  check(finished, ErrorCode::cancelled, "cancelled while {}", kCheckingStage);
  checkReadable(std::move(faults));
}

bool writeColmapMasks(const PoseOptions& options, const ColmapPhotographs& photographs) {
  bool any = false;
  for (std::size_t i = 0; i < photographs.names.size(); ++i) {
    const std::string& name = photographs.names[i];
    const ImageFileInfo& info = photographs.infos[i];
    const auto mask = maskOf(options, name);
    if (!mask) continue;
    const fs::path to = options.folder / "masks" / (name + ".png");
    makeFolders(to.parent_path());
    if (isRotated(options, info))
      writeImage(to, upright(readImage(*mask), info.orientation));
    else
      writeFile(to, readFile(*mask));
    any = true;
  }
  return any;
}

bool haveOneSize(const PoseOptions& options, const ColmapPhotographs& photographs,
                 std::span<const std::size_t> indices) {
  return std::ranges::all_of(indices, [&](std::size_t i) {
    return uprightSize(options, photographs.infos[i]) == uprightSize(options, photographs.infos[indices[0]]);
  });
}

bool foldersHaveOneSize(const PoseOptions& options, const ColmapPhotographs& photographs,
                        std::span<const std::size_t> indices) {
  if (haveOneSize(options, photographs, indices)) return false;
  std::map<fs::path, std::pair<int, int>> sizes;
  return std::ranges::all_of(indices, [&](std::size_t i) {
    const auto size = uprightSize(options, photographs.infos[i]);
    return sizes.emplace(fs::path(photographs.names[i]).parent_path(), size).first->second == size;
  });
}

}  // namespace ibr
