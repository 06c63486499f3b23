// SPDX-License-Identifier: Apache-2.0
// Reads COLMAP's text files. Departure: COLMAP ends an image's name at the first space, libibr at the line's end.
#include <algorithm>
#include <limits>
#include <optional>
#include <string_view>

#include "author/poses/colmap_records.h"
#include "base/check.h"
#include "base/file.h"
#include "base/parse.h"

namespace ibr::colmap {
namespace {

constexpr std::string_view kBlank = " \t\r";

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(kBlank);
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

// Parses one line, word by word.
class Line {
 public:
  Line(std::string_view text, RecordLocation location) : rest_(trimmed(text)), location_(location) {}
  const RecordLocation& location() const { return location_; }
  bool atEnd() const { return rest_.empty(); }

  std::string_view word(const char* field) {
    check(!atEnd(), ErrorCode::invalidInput, "{}: the line ends before {}", location_.describe(), field);
    const auto end = std::min(rest_.find_first_of(kBlank), rest_.size());
    const std::string_view found = rest_.substr(0, end);
    rest_ = trimmed(rest_.substr(end));
    return found;
  }
  double real(const char* field) {
    const std::string_view text = word(field);
    const std::optional<double> value = parseDouble(text);
    check(value.has_value(), ErrorCode::invalidInput, "{}: {} \"{}\" is not a finite number", location_.describe(),
          field, text);
    return *value;
  }
  std::int64_t integer(const char* field, std::int64_t least, std::int64_t most) {
    const std::string_view text = word(field);
    const std::optional<std::int64_t> value = parseInt(text);
    check(value && *value >= least && *value <= most, ErrorCode::invalidInput,
          "{}: {} \"{}\" is not a whole number from {} to {}", location_.describe(), field, text, least, most);
    return *value;
  }
  std::string_view remainder() { return std::exchange(rest_, {}); }

 private:
  std::string_view rest_;
  RecordLocation location_;
};

constexpr std::int64_t kMaxId = std::numeric_limits<std::int64_t>::max();

class Lines {
 public:
  explicit Lines(const std::filesystem::path& file) : file_(&file), text_(readTextFile(file, std::uint64_t(8) << 30)) {}

  /// Returns the next line unchanged.
  std::optional<Line> raw() {
    if (at_ >= text_.size()) return std::nullopt;
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    const std::string_view line(text_.data() + at_, end - at_);
    at_ = end + 1;
    return Line(line, {file_, ++number_, true});
  }
  /// Returns the next line that is neither empty nor a comment.
  std::optional<Line> nextContentLine() {
    while (auto line = raw()) {
      Line probe = *line;
      if (!probe.atEnd() && probe.word("")[0] != '#') return line;
    }
    return std::nullopt;
  }

 private:
  const std::filesystem::path* file_;
  std::string text_;
  std::size_t at_ = 0;
  std::uint64_t number_ = 0;
};

void readCameras(Records& records) {
  Lines lines(records.camerasFile);
  while (auto line = lines.nextContentLine()) {
    CameraRecord camera{line->location(), 0, 0, 0, 0, {}};
    camera.id = std::uint64_t(line->integer("CAMERA_ID", 0, std::int64_t(kNoCamera) - 1));
    const std::string_view model = line->word("MODEL");
    const auto kind =
        std::find_if(kModelKinds.begin(), kModelKinds.end(), [&](const ModelKind& k) { return k.name == model; });
    check(kind != kModelKinds.end(), ErrorCode::unsupported, "{}: MODEL \"{}\" of camera {} is not known",
          camera.location.describe(), model, camera.id);
    camera.kind = std::size_t(kind - kModelKinds.begin());
    camera.width = std::uint64_t(line->integer("WIDTH", 0, kMaxId));
    camera.height = std::uint64_t(line->integer("HEIGHT", 0, kMaxId));
    while (!line->atEnd()) camera.parameters.push_back(line->real("PARAMS"));
    const bool bare = camera.kind == kEquirectangular && camera.parameters.empty();
    check(camera.parameters.size() == kind->parameters || bare, ErrorCode::invalidInput,
          "{}: camera {} has {} PARAMS, but {} takes {}", camera.location.describe(), camera.id,
          camera.parameters.size(), kind->name, kind->parameters);
    records.cameras.push_back(std::move(camera));
  }
}

void readImages(Records& records) {
  Lines lines(records.imagesFile);
  while (auto line = lines.nextContentLine()) {
    ImageRecord image{line->location(), 0, {}, {}, 0, {}, {}};
    image.id = std::uint64_t(line->integer("IMAGE_ID", 0, std::int64_t(kNoCamera) - 1));
    constexpr const char* kFields[] = {"QW", "QX", "QY", "QZ", "TX", "TY", "TZ"};
    for (std::size_t i = 0; i < 4; ++i) image.quaternion[i] = line->real(kFields[i]);
    for (std::size_t i = 0; i < 3; ++i) image.translation[i] = line->real(kFields[4 + i]);
    const std::int64_t camera = line->integer("CAMERA_ID", -1, std::int64_t(kNoCamera));
    image.camera = camera < 0 ? kNoCamera : std::uint64_t(camera);
    image.name = line->remainder();
    if (auto points = lines.raw()) {  // absent only after the last image
      while (!points->atEnd()) {
        ObservationRecord observation{points->real("X"), points->real("Y"), kNoPoint};
        const std::int64_t point = points->integer("POINT3D_ID", -1, kMaxId);
        if (point >= 0) observation.point = std::uint64_t(point);
        image.observations.push_back(observation);
      }
    }
    records.images.push_back(std::move(image));
  }
}

void readPoints(Records& records) {
  Lines lines(records.pointsFile);
  while (auto line = lines.nextContentLine()) {
    PointRecord point{line->location(), 0, {}};
    point.id = std::uint64_t(line->integer("POINT3D_ID", 0, kMaxId));
    constexpr const char* kFields[] = {"X", "Y", "Z"};
    for (std::size_t i = 0; i < 3; ++i) point.position[i] = line->real(kFields[i]);
    records.points.push_back(point);  // colour, error and track repeat what the images contain
  }
}

}  // namespace

void readText(Records& records) {
  readCameras(records);
  readImages(records);
  if (!records.pointsFile.empty()) readPoints(records);
}

}  // namespace ibr::colmap
