// SPDX-License-Identifier: Apache-2.0
// Writes COLMAP's text files. Frames: author/geometry/world_to_camera.h.
#include <algorithm>
#include <glm/gtc/quaternion.hpp>
#include <iterator>

#include "author/geometry/lens_distortion.h"
#include "author/poses/colmap_records.h"
#include "base/check.h"
#include "base/file.h"
#include "ibr/author/poses.h"

namespace ibr {
namespace {

template <class... Args>
void append(std::string& text, fmt::format_string<Args...> format, Args&&... args) {
  fmt::format_to(std::back_inserter(text), format, std::forward<Args>(args)...);
}

// Names may not begin or end with blanks: the reader takes the rest of a line, trimmed.
void checkName(const std::string& name) {
  const bool ends =
      !name.empty() && name.front() != ' ' && name.back() != ' ' && name.front() != '\t' && name.back() != '\t';
  check(ends && name.find_first_of("\r\n") == name.npos, ErrorCode::invalidInput,
        "\"{}\" is not a valid image name in a COLMAP text model: no blanks at either end, no line breaks", name);
}

// Formats a camera for cameras.txt, without the camera's number.
std::string cameraText(const PosedImage& image) {
  if (const auto& lens = image.lens) {
    std::string text =
        fmt::format("{} {} {}", colmap::kModelKinds[std::size_t(lens->model())].name, lens->width(), lens->height());
    for (const double v : parametersOf(*lens)) append(text, " {}", v);
    return text;
  }
  const Intrinsics& k = image.camera.intrinsics;
  return k.model == CameraModel::equirectangular
             ? fmt::format("EQUIRECTANGULAR {} {} {} {}", k.width, k.height, k.width, k.height)
             : fmt::format("PINHOLE {} {} {} {} {} {}", k.width, k.height, k.fx, k.fy, k.cx, k.cy);
}

// Maps an undistorted pixel to the source photograph, distortion included.
glm::dvec2 sourcePixel(const PosedImage& image, glm::dvec2 pixel) {
  const auto seen = image.lens ? image.lens->project(unproject(image.camera.intrinsics, pixel)) : std::optional(pixel);
  check(seen.has_value(), ErrorCode::invalidInput,
        "{}: the observation at pixel {}, {} is outside the field of view of the image's lens", image.name, pixel.x,
        pixel.y);
  return *seen;
}

}  // namespace

void writeColmapModel(const PosedModel& model, const std::filesystem::path& folder) {
  std::string cameras = "# CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n",
              images = "# IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME\n# POINTS2D[] as (X, Y, POINT3D_ID)\n",
              points = "# POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)\n";
  std::vector<std::string> seen(model.images.size());
  std::vector<std::size_t> count(model.images.size(), 0);
  for (std::size_t t = 0; t < model.tracks.size(); ++t) {
    const glm::dvec3 p = model.tracks[t].position;
    append(points, "{} {} {} {} 128 128 128 -1", t + 1, p.x, p.y, p.z);  // −1: COLMAP's value for an unknown error
    for (const TrackObservation& o : model.tracks[t].observations) {
      check(o.image < model.images.size(), ErrorCode::invalidInput,
            "track {} refers to image {}, but there are only {} images", t, o.image, model.images.size());
      append(points, " {} {}", o.image + 1, count[o.image]++);
      const glm::dvec2 pixel = sourcePixel(model.images[o.image], o.pixel);
      append(seen[o.image], "{}{} {} {}", seen[o.image].empty() ? "" : " ", pixel.x, pixel.y, t + 1);
    }
    points += '\n';
  }
  std::vector<std::string> known;
  for (std::size_t i = 0; i < model.images.size(); ++i) {
    const std::string& name = model.images[i].name;
    const Camera& camera = model.images[i].camera;
    checkName(name);
    const std::string text = cameraText(model.images[i]);
    const auto number = std::size_t(std::ranges::find(known, text) - known.begin());
    if (number == known.size()) {
      known.push_back(text);
      append(cameras, "{} {}\n", number + 1, text);
    }
    const glm::dquat halfTurnAboutX(0.0, 1.0, 0.0, 0.0);  // y up, −z forward → y down, z forward
    const glm::dquat q = glm::conjugate(camera.pose.rotation * halfTurnAboutX);
    const glm::dvec3 t = -(q * camera.pose.position);
    append(images, "{} {} {} {} {} {} {} {} {} {}\n{}\n", i + 1, q.w, q.x, q.y, q.z, t.x, t.y, t.z, number + 1, name,
           seen[i]);
  }
  makeFolders(folder);
  writeFile(folder / "cameras.txt", cameras);
  writeFile(folder / "images.txt", images);
  writeFile(folder / "points3D.txt", points);
}

}  // namespace ibr
