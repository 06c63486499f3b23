// SPDX-License-Identifier: Apache-2.0
#include "author/build/stored_photographs.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "author/build/find_movers.h"
#include "author/geometry/posed_model.h"
#include "author/jobs/cached_file.h"
#include "author/photographs/masks.h"
#include "base/file.h"
#include "io/image_file.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

constexpr double kSuspiciousMaskedShare = 0.9;  // masked share of a photograph above which the mask may be inverted

// Adds `moved` to the photograph's mask, if any, and updates its hash.
void addMask(BuildInput& input, std::size_t i, const BitMask& moved, const BuildOptions& options) {
  Photograph& photo = input.photographs[i];
  Image8 mask = maskOf(moved, photo.camera.intrinsics.width, photo.camera.intrinsics.height);
  if (!photo.storedMask.empty()) mask = combinedMask(mask, storedMask(photo));
  Hash hash;
  hash.add(input.hashes[i]);
  hash.add(storeMask(photo, mask, loadPhotograph(photo), options.output, options.texture));
  input.hashes[i] = hash.value();
}

}  // namespace

double bytesToStoreOne(const BuildInput& input) {
  double bytes = 0;
  for (const Photograph& photo : input.photographs) bytes = std::max(bytes, bytesToStore(photo));
  return bytes;
}

fs::path cachedMask(const BuildOptions& options, std::uint64_t hash) {
  return cacheFile(buildCacheFolder(options), hash, "png");
}

void hashAndCacheMask(BuildInput& input, std::uint32_t photograph, const BuildOptions& options) {
  Photograph& photo = input.photographs[photograph];
  input.hashes[photograph] = hashPhotograph(photo);
  if (photo.mask.empty()) return;
  photo.storedMask = cachedMask(options, input.hashes[photograph]);
  writeImage(photo.storedMask, loadMask(photo, photo.mask));
}

void hashPhotographs(BuildInput& input, const BuildOptions& options, const BuildJobs& jobs) {
  makeFolders(buildCacheFolder(options));
  input.hashes.resize(input.photographs.size());
  double bytes = 0;
  for (const Photograph& photo : input.photographs) bytes = std::max(bytes, photo.sourcePixels + bytesToLoad(photo));
  jobs.runAll("reading photographs", input.photographs.size(), bytes,
              [&](std::size_t i) { hashAndCacheMask(input, std::uint32_t(i), options); });
}

std::vector<Node> storePhotographs(BuildInput& input, const BuildOptions& options, const BuildJobs& jobs) {
  makeFolders(buildCacheFolder(options));
  input.hashes.resize(input.photographs.size());
  std::vector<std::string> faults(input.photographs.size());  // all are reported at once
  jobs.runAll("storing photographs", input.photographs.size(), bytesToStoreOne(input), [&](std::size_t i) {
    try {
      input.hashes[i] = storePhotograph(input.photographs[i], options.output, options.texture);
    } catch (const Error& error) {
      if (!isFileError(error)) throw;
      faults[i] = error.what();
    }
  });
  checkReadable(std::move(faults));
  std::vector<Node> nodes;
  for (const Photograph& photo : input.photographs)
    nodes.push_back({photo.name, photo.camera, photo.imageFile, photo.textureFile,
                     photo.stripped ? CaptureMetadata() : photo.capture});
  for (std::size_t n = 0; n < nodes.size(); ++n)
    if (const Photograph& photo = input.photographs[n]; !photo.storedMask.empty())
      nodes[n].maskFile = storedMaskFile(photo.name);
  return nodes;
}

std::vector<BuildReport::MaskReport> applyMasksToTracks(BuildInput& input, const LogCallback& log) {
  std::vector<BuildReport::MaskReport> masks;
  for (std::uint32_t i = 0; i < input.photographs.size(); ++i) {  // one mask is held at a time
    const Image8 mask = storedMask(input.photographs[i]);
    const double share = ignoredShare(mask);
    if (share > 0) masks.push_back({input.photographs[i].name, share, 0});
    if (share > kSuspiciousMaskedShare && log)
      log(LogLevel::warning,
          fmt::format("{}: the mask leaves {:.0f} % of the photograph. Pixels of value 0 are ignored, all others are "
                      "used; check that the mask is not inverted",
                      input.photographs[i].name, 100 * (1 - share)));
    dropMaskedObservations(input.model, i, input.tracksOf[i], mask);
  }
  if (masks.empty()) return masks;
  dropUnobservedTracks(input.model);
  input.tracksOf = tracksOfImages(input.model);
  return masks;
}

void addMasks(BuildInput& input, std::vector<Node>& nodes, const std::vector<BitMask>& moved,
              const BuildOptions& options, const BuildJobs& jobs) {
  jobs.runAll("masking moving objects", moved.size(), bytesToStoreOne(input), [&](std::size_t i) {
    if (moved[i].empty()) return;
    addMask(input, i, moved[i], options);
    nodes[i].maskFile = storedMaskFile(input.photographs[i].name);
  });
}

}  // namespace ibr
