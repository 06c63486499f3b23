// SPDX-License-Identifier: Apache-2.0
// Reads the input of harmonise() from files, and writes its result into a folder.
#include <algorithm>
#include <optional>
#include <set>

#include "author/photographs/masks.h"
#include "author/photographs/photographs.h"
#include "author/surface/triangle_mesh_file.h"
#include "base/check.h"
#include "base/file.h"
#include "ibr/author/htm.h"
#include "ibr/author/poses.h"
#include "io/image_file.h"
#include "scene/htm_model_file.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

fs::path maskFile(const fs::path& folder, const std::string& name) {
  const std::optional<fs::path> file = findMaskFile(folder, name);
  check(file.has_value(), ErrorCode::io, "{}: not found; the mask of {} must be this file or {}",
        (folder / name).replace_extension(".png").string(), name, (folder / (name + ".png")).string());
  return *file;
}

struct Size {
  int width, height;
  bool operator==(const Size&) const = default;
};
Size sizeOf(const fs::path& file, bool upright) {
  const ImageFileInfo info = probeImage(file);
  return upright && info.orientation >= 5 ? Size{info.height, info.width} : Size{info.width, info.height};
}

// Applies the photograph's orientation, undistortion and resizing to the mask.
Image8 loadObjectMask(Photograph photograph, const fs::path& file) {
  const Size wanted = sizeOf(photograph.source, photograph.applyOrientation),
             size = sizeOf(file, photograph.applyOrientation);
  check(size == wanted, ErrorCode::invalidInput, "{}: the mask is {} × {} px, {} is {} × {} px", file.string(),
        size.width, size.height, photograph.source.string(), wanted.width, wanted.height);
  photograph.source = file;
  const Image8 colour = loadPhotograph(photograph);
  Image8 mask(colour.width, colour.height, 1);
  for (std::size_t p = 0; p < mask.values.size(); ++p) mask.values[p] = colour.values[3 * p];
  return mask;
}

PosedModel chosenModel(const HtmBuildOptions& options, const LogCallback& log) {
  PosedModel model = readPoseFile(options.model, options.images, log);
  std::set<std::string> unknown(options.exclude.begin(), options.exclude.end());
  std::erase_if(model.images, [&](const PosedImage& image) {
    unknown.erase(image.name);
    return std::ranges::find(options.exclude, image.name) != options.exclude.end();
  });
  check(unknown.empty(), ErrorCode::invalidInput, "{}: no image {} to exclude", options.model.string(),
        unknown.empty() ? std::string() : *unknown.begin());
  check(!model.images.empty() && model.images.size() <= kMaxHtmCameraCount, ErrorCode::invalidInput,
        "{}: {} images, must be 1 to {}", options.model.string(), model.images.size(), kMaxHtmCameraCount);
  return model;
}

struct Input {
  TriangleMesh mesh;
  std::vector<Photograph> files;
  std::vector<HtmPhotograph> photographs;
};

Input readInput(const HtmBuildOptions& options, const LogCallback& log) {
  Input input{readTriangleMesh(options.mesh), {}, {}};
  const PosedModel model = chosenModel(options, log);
  for (const PosedImage& image : model.images)
    input.files.push_back(findPhotograph(options.images, image, options.maxSize));
  for (const Photograph& file : input.files) {
    HtmPhotograph photograph{{file.name, file.camera, file.imageFile, {}}, loadPhotograph(file), {}};
    if (!options.masks.empty()) photograph.mask = loadObjectMask(file, maskFile(options.masks, file.name));
    input.photographs.push_back(std::move(photograph));
  }
  return input;
}

fs::path visibilityFile(const std::string& name) {
  return fs::path("visibility") / (name + ".png");
}

// Throws Error{invalidInput} if the model would overwrite its own input.
void checkInputNotOverwritten(const Input& input, const HtmBuildOptions& options) {
  const auto demandOther = [&](const fs::path& from, const fs::path& to) {
    std::error_code ignored;
    check(!fs::equivalent(from, options.output / to, ignored), ErrorCode::invalidInput,
          "{}: the output would overwrite this file; choose another output folder", from.string());
  };
  demandOther(options.mesh, kHtmModelFileName);
  for (const Photograph& file : input.files) {
    checkNotOverwritten(file, options.output);
    if (!options.masks.empty()) demandOther(maskFile(options.masks, file.name), visibilityFile(file.name));
  }
}

}  // namespace

std::pair<TriangleMesh, std::vector<HtmPhotograph>> readHtmInput(const HtmBuildOptions& options,
                                                                 const LogCallback& log) {
  Input input = readInput(options, log);
  return {std::move(input.mesh), std::move(input.photographs)};
}

HtmResult buildHtm(const HtmBuildOptions& options, const ProgressCallback& progress, const LogCallback& log) {
  checkFolderWritable(options.output);
  Input input = readInput(options, log);
  checkInputNotOverwritten(input, options);
  for (HtmPhotograph& photograph : input.photographs)
    photograph.camera.visibilityFile = visibilityFile(photograph.camera.name);
  HtmResult result = harmonise(input.mesh, input.photographs, options.optimise, progress);
  for (std::size_t i = 0; i < input.files.size(); ++i) {
    storePicture(input.files[i], options.output);
    const fs::path file = options.output / result.model.cameras[i].visibilityFile;
    makeFolders(file.parent_path());
    writeImage(file, result.visibility[i]);
  }
  result.model.settings = htmOptionsToJson(options);
  saveHtmModel(result.model, options.output);
  return result;
}

}  // namespace ibr
