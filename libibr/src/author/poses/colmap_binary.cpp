// SPDX-License-Identifier: Apache-2.0
// Reads COLMAP's binary files: little-endian, no header, each file a count and its records.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "author/poses/colmap_records.h"
#include "base/check.h"
#include "base/file.h"

namespace ibr::colmap {
namespace {

static_assert(std::endian::native == std::endian::little,
              "COLMAP's binary files are little-endian: bytes are not swapped");

class Bytes {
 public:
  explicit Bytes(const std::filesystem::path& file) : file_(&file), bytes_(readFile(file, std::uint64_t(16) << 30)) {}

  RecordLocation location() const { return {file_, at_, false}; }
  std::uint64_t left() const { return bytes_.size() - at_; }

  template <class T>
  T value(const char* field) {
    need(sizeof(T), field);
    T result;
    std::memcpy(&result, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return result;
  }
  double real(const char* field) {
    const RecordLocation here = location();
    const double result = value<double>(field);
    check(std::isfinite(result), ErrorCode::invalidInput, "{}: {} is not a finite number", here.describe(), field);
    return result;
  }
  /// Reads a count of records of at least `size` bytes; a count beyond the file's end fails before any allocation.
  std::uint64_t count(const char* field, std::uint64_t size) {
    const RecordLocation here = location();
    const auto result = value<std::uint64_t>(field);
    check(result <= left() / size, ErrorCode::invalidInput, "{}: {} is {}, but only {} bytes follow", here.describe(),
          field, result, left());
    return result;
  }
  std::string text(const char* field) {
    const RecordLocation here = location();
    const auto* const first = reinterpret_cast<const char*>(bytes_.data() + at_);
    const auto* const end = static_cast<const char*>(left() > 0 ? std::memchr(first, 0, left()) : nullptr);
    check(end != nullptr, ErrorCode::invalidInput, "{}: {} has no terminating zero byte", here.describe(), field);
    at_ += std::uint64_t(end - first) + 1;
    return {first, end};
  }
  void skip(std::uint64_t size, const char* field) {
    need(size, field);
    at_ += size;
  }
  void finish() const {
    check(left() == 0, ErrorCode::invalidInput, "{}: {} unexpected bytes after the last record", location().describe(),
          left());
  }

 private:
  void need(std::uint64_t size, const char* field) const {
    check(size <= left(), ErrorCode::invalidInput, "{}: the file ends within {}", location().describe(), field);
  }

  const std::filesystem::path* file_;
  std::vector<std::byte> bytes_;
  std::uint64_t at_ = 0;
};

void readCameras(Records& records) {
  Bytes file(records.camerasFile);
  for (std::uint64_t n = file.count("number of cameras", 24); n > 0; --n) {
    CameraRecord camera{file.location(), 0, 0, 0, 0, {}};
    camera.id = file.value<std::uint32_t>("CAMERA_ID");
    const auto number = file.value<std::int32_t>("MODEL");
    const auto kind = std::ranges::find(kModelKinds, number, &ModelKind::number);
    check(kind != kModelKinds.end(), ErrorCode::unsupported, "{}: MODEL {} of camera {} is not known",
          camera.location.describe(), number, camera.id);
    camera.kind = std::size_t(kind - kModelKinds.begin());
    camera.width = file.value<std::uint64_t>("WIDTH");
    camera.height = file.value<std::uint64_t>("HEIGHT");
    for (std::size_t i = 0; i < kind->parameters; ++i) camera.parameters.push_back(file.real("PARAMS"));
    records.cameras.push_back(std::move(camera));
  }
  file.finish();
}

void readImages(Records& records) {
  Bytes file(records.imagesFile);
  for (std::uint64_t n = file.count("number of images", 73); n > 0; --n) {
    ImageRecord image{file.location(), 0, {}, {}, 0, {}, {}};
    image.id = file.value<std::uint32_t>("IMAGE_ID");
    for (double& q : image.quaternion) q = file.real("QVEC");
    for (double& t : image.translation) t = file.real("TVEC");
    image.camera = file.value<std::uint32_t>("CAMERA_ID");
    image.name = file.text("NAME");
    const std::uint64_t observations = file.count("number of POINTS2D", 24);
    image.observations.reserve(observations);
    for (std::uint64_t i = 0; i < observations; ++i) {
      const double x = file.real("X"), y = file.real("Y");
      image.observations.push_back({x, y, file.value<std::uint64_t>("POINT3D_ID")});
    }
    records.images.push_back(std::move(image));
  }
  file.finish();
}

void readPoints(Records& records) {
  Bytes file(records.pointsFile);
  for (std::uint64_t n = file.count("number of points", 51); n > 0; --n) {
    PointRecord point{file.location(), 0, {}};
    point.id = file.value<std::uint64_t>("POINT3D_ID");
    for (double& x : point.position) x = file.real("XYZ");
    file.skip(3 + 8, "RGB and ERROR");
    file.skip(8 * file.count("length of TRACK", 8), "TRACK");
    records.points.push_back(point);
  }
  file.finish();
}

}  // namespace

void readBinary(Records& records) {
  readCameras(records);
  readImages(records);
  if (!records.pointsFile.empty()) readPoints(records);
}

}  // namespace ibr::colmap
