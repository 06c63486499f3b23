// SPDX-License-Identifier: Apache-2.0
// Reads Bundler's bundle.out v0.3. A camera sees the world point X at f·(1 + k1·r² + k2·r⁴)·p, measured from the
// image's centre, y up, with p = −P/P.z of P = R·X + t. These are libibr's camera axes. Names are in a list beside.
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>
#include <limits>

#include "author/poses/pose_source.h"
#include "author/poses/text_words.h"
#include "base/check.h"
#include "base/file.h"
#include "base/parse.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

constexpr std::int64_t kMaxCount = std::numeric_limits<std::int32_t>::max();

// Removes what Bundler writes behind a name: "a.jpg 0 532.5".
std::string nameOf(std::string_view line) {
  std::string_view rest = line;
  for (int numbers = 0; numbers < 2; ++numbers) {
    const std::size_t blank = rest.find_last_of(" \t");
    if (blank == rest.npos || !parseDouble(rest.substr(blank + 1))) return std::string(line);
    rest = rest.substr(0, blank);
    while (!rest.empty() && (rest.back() == ' ' || rest.back() == '\t')) rest.remove_suffix(1);
  }
  return std::string(rest);
}

struct NameList {
  fs::path file;
  std::vector<std::string> names;
};

NameList readNames(const fs::path& bundle) {
  const fs::path folder = bundle.parent_path();
  const std::string stem = bundle.stem().string();  // COLMAP writes NAME.bundle.out and NAME.list.txt
  const std::string name = stem.ends_with(".bundle") ? fs::path(stem).stem().string() : stem;
  std::string tried;
  for (const fs::path& file : {folder / (name + ".list.txt"), folder / "list.txt", folder / ".." / "list.txt"}) {
    std::error_code ignored;
    if (!fs::is_regular_file(file, ignored)) {
      tried += (tried.empty() ? "" : ", ") + file.lexically_normal().string();
      continue;
    }
    NameList list{file, {}};
    const std::string text = readTextFile(file);
    TextWords words(list.file, text);
    while (!words.atEnd()) list.names.push_back(nameOf(words.restOfLine()));
    return list;
  }
  fail(ErrorCode::io, "{}: there is no list of its images ({})", bundle.string(), tried);
}

}  // namespace

PosedModel readBundler(PoseSource& source) {
  TextWords words(source.path, source.text);
  if (words.restOfLine() != "# Bundle file v0.3")
    fail(ErrorCode::unsupported, "{}: is not \"# Bundle file v0.3\"; other versions are not supported", words.where());
  const std::int64_t cameras = words.integer("the number of cameras", 1, kMaxCount);
  const std::int64_t points = words.integer("the number of points", 0, kMaxCount);
  const NameList list = readNames(source.path);
  PosedModel model;
  std::vector<std::int64_t> imageOf;  // of each camera; −1: not registered
  std::size_t lost = 0;
  for (std::int64_t i = 0; i < cameras; ++i) {
    const double focal = words.real("the focal length");
    const double k1 = words.real("k1"), k2 = words.real("k2");
    std::array<double, 9> rows{};
    for (double& value : rows) value = words.real("a value of R");
    glm::dvec3 translation;
    for (int c = 0; c < 3; ++c) translation[c] = words.real("a value of t");
    if (std::size_t(i) >= list.names.size())
      fail(ErrorCode::invalidInput, "{}: has {} names, but {} has {} cameras", list.file.string(), list.names.size(),
           source.path.string(), cameras);
    imageOf.push_back(focal == 0 ? -1 : std::int64_t(model.images.size()));
    if (focal == 0) {
      ++lost;
      continue;
    }
    const glm::dmat3 toCamera = matrixOfRows(rows);
    if (const auto fault = rotationFault(toCamera)) words.fault(fmt::format("R of camera {} {}", i, *fault));
    PosedImage image;
    image.name = list.names[std::size_t(i)];
    const glm::dquat rotation = glm::conjugate(rotationOf(toCamera));
    image.camera.pose = {-(rotation * translation), rotation};
    const ImageSize size = source.sizeOf(image.name);
    try {
      setLens(image, LensModel::radial, size.width, size.height, {focal, 0.5 * size.width, 0.5 * size.height, k1, k2},
              source.border);
    } catch (const Error& e) {
      words.fault(fmt::format("camera {} ({}): {}", i, image.name, e.what()));
    }
    model.images.push_back(std::move(image));
  }
  if (lost > 0) source.warn(fmt::format("{} of {} images are not registered", lost, cameras));
  for (std::int64_t p = 0; p < points; ++p) {
    Track track;
    for (int c = 0; c < 3; ++c) track.position[c] = words.real("a point's position");
    for (int c = 0; c < 3; ++c) words.real("a point's colour");
    const std::int64_t views = words.integer("the number of a point's views", 0, kMaxCount);
    for (std::int64_t v = 0; v < views; ++v) {
      const std::int64_t camera = words.integer("a view's camera", 0, cameras - 1);
      words.integer("a view's feature", -1, std::numeric_limits<std::int64_t>::max());
      const double x = words.real("a view's x"), y = words.real("a view's y");
      const std::int64_t image = imageOf[std::size_t(camera)];
      if (image < 0) continue;
      const ImageSize size = sizeAsStored(model.images[std::size_t(image)]);
      observe(track, model, std::uint32_t(image), {0.5 * size.width + x, 0.5 * size.height - y});
    }
    model.tracks.push_back(std::move(track));
  }
  return model;
}

}  // namespace ibr
