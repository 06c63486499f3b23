// SPDX-License-Identifier: Apache-2.0
// Reads PLY (Turk, The PLY Polygon File Format, 1994): a header lists elements and properties; their values follow.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <string>

#include "author/surface/triangle_mesh_file.h"
#include "base/check.h"
#include "base/file.h"
#include "base/parse.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

enum class Type { i8, u8, i16, u16, i32, u32, f32, f64 };
constexpr std::array kNames{"char", "uchar", "short", "ushort", "int",   "uint",   "float",   "double",
                            "int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64"};
constexpr std::array<std::size_t, 8> kBytes{1, 1, 2, 2, 4, 4, 4, 8};

struct Property {
  std::string name;
  Type type;
  std::optional<Type> count;  // of a list
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

class PlyReader {
 public:
  explicit PlyReader(const fs::path& path) : path_(path.string()), bytes_(readFile(path)) {}

  TriangleMesh read() {
    header();
    TriangleMesh mesh;
    for (const Element& element : elements_) {
      if (element.properties.empty()) continue;
      checkCount(element);
      if (element.name == "vertex")
        vertices(element, mesh);
      else if (element.name == "face")
        faces(element, mesh);
      else
        for (std::size_t i = 0; i < element.count; ++i)
          for (const Property& property : element.properties) skip(property);
    }
    return mesh;
  }

 private:
  template <class... Args>
  void demand(bool holds, fmt::format_string<Args...> format, Args&&... args) const {
    if (!holds) fail(ErrorCode::invalidInput, "{}: {}", path_, fmt::format(format, std::forward<Args>(args)...));
  }

  std::string_view text() const { return {reinterpret_cast<const char*>(bytes_.data()), bytes_.size()}; }

  std::string_view line() {
    const std::size_t end = text().find('\n', at_);
    demand(end != std::string_view::npos, "the header has no end_header");
    std::string_view line = text().substr(at_, end - at_);
    at_ = end + 1;
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
  }

  static std::vector<std::string_view> words(std::string_view line) {
    std::vector<std::string_view> words;
    for (std::size_t at = 0; (at = line.find_first_not_of(" \t", at)) != std::string_view::npos;) {
      const std::size_t end = std::min(line.find_first_of(" \t", at), line.size());
      words.push_back(line.substr(at, end - at));
      at = end;
    }
    return words;
  }

  Type type(std::string_view name) const {
    const auto found = std::find(kNames.begin(), kNames.end(), name);
    demand(found != kNames.end(), "\"{}\" is not a property type", name);
    return Type((found - kNames.begin()) % 8);
  }

  void header() {
    demand(line() == "ply", "is not a PLY file");
    bool hasFormat = false;
    for (;;) {
      const std::vector<std::string_view> word = words(line());
      if (word.empty() || word[0] == "comment" || word[0] == "obj_info") continue;
      if (word[0] == "end_header") break;
      if (word[0] == "format" && word.size() == 3) {
        hasFormat = true;
        ascii_ = word[1] == "ascii";
        swapped_ = word[1] == "binary_big_endian";
        demand(ascii_ || swapped_ || word[1] == "binary_little_endian", "\"{}\" is not a format", word[1]);
      } else if (word[0] == "element" && word.size() == 3) {
        const auto count = parseInt(word[2]);
        demand(count && *count >= 0, "\"{}\" is not an element count", word[2]);
        elements_.push_back({std::string(word[1]), std::size_t(*count), {}});
      } else if (word[0] == "property" && !elements_.empty() && word.size() == 5 && word[1] == "list") {
        elements_.back().properties.push_back({std::string(word[4]), type(word[3]), type(word[2])});
      } else if (word[0] == "property" && !elements_.empty() && word.size() == 3) {
        elements_.back().properties.push_back({std::string(word[2]), type(word[1]), std::nullopt});
      } else {
        demand(false, "\"{}\" is not a valid header line", word[0]);
      }
    }
    demand(hasFormat, "the header has no format");
  }

  // Checks a count against the file's size before any allocation.
  void checkCount(const Element& element) const {
    std::size_t least = 0;
    for (const Property& property : element.properties)
      least += ascii_ ? 1 : kBytes[std::size_t(property.count.value_or(property.type))];
    demand(element.count <= (bytes_.size() - at_ + 1) / least, "is cut short: {} elements of \"{}\" do not fit into it",
           element.count, element.name);
  }

  double number(Type type) {
    if (ascii_) {
      at_ = std::min(text().find_first_not_of(" \t\r\n", at_), text().size());
      const std::size_t end = std::min(text().find_first_of(" \t\r\n", at_), text().size());
      demand(end > at_, "is cut short");
      const std::string_view word = text().substr(at_, end - at_);
      const auto value = parseDouble(word);
      demand(value.has_value(), "\"{}\" at byte {} is not a finite number", word.substr(0, 40), at_);
      at_ = end;
      return *value;
    }
    const std::size_t size = kBytes[std::size_t(type)];
    demand(bytes_.size() - at_ >= size, "is cut short");
    std::array<std::byte, 8> raw{};
    std::copy_n(bytes_.begin() + std::ptrdiff_t(at_), size, raw.begin());
    if (swapped_) std::reverse(raw.begin(), raw.begin() + std::ptrdiff_t(size));
    at_ += size;
    const auto as = [&]<class T>(T value) {
      std::memcpy(&value, raw.data(), sizeof value);
      return double(value);
    };
    switch (type) {
      case Type::i8:
        return as(std::int8_t());
      case Type::u8:
        return as(std::uint8_t());
      case Type::i16:
        return as(std::int16_t());
      case Type::u16:
        return as(std::uint16_t());
      case Type::i32:
        return as(std::int32_t());
      case Type::u32:
        return as(std::uint32_t());
      case Type::f32:
        return as(float());
      case Type::f64:
        break;
    }
    return as(double());
  }

  void skip(const Property& property) {
    const double count = property.count ? number(*property.count) : 1.0;
    for (double i = 0; i < count; ++i) number(property.type);
  }

  void vertices(const Element& element, TriangleMesh& mesh) {
    std::array<bool, 3> has{};
    for (const Property& property : element.properties)
      if (property.name.size() == 1 && property.name[0] >= 'x' && property.name[0] <= 'z' && !property.count)
        has[std::size_t(property.name[0] - 'x')] = true;
    demand(has[0] && has[1] && has[2], "its vertices lack x, y or z");
    mesh.positions.resize(element.count);
    for (glm::dvec3& position : mesh.positions)
      for (const Property& property : element.properties) {
        if (property.count || property.name.size() != 1 || property.name[0] < 'x' || property.name[0] > 'z')
          skip(property);
        else
          position[property.name[0] - 'x'] = number(property.type);
      }
  }

  void faces(const Element& element, TriangleMesh& mesh) {
    const auto isCorners = [](const Property& p) {
      return p.count && (p.name == "vertex_indices" || p.name == "vertex_index");
    };
    demand(std::any_of(element.properties.begin(), element.properties.end(), isCorners),
           "its faces have no list vertex_indices");
    mesh.triangles.reserve(element.count);
    for (std::size_t f = 0; f < element.count; ++f)
      for (const Property& property : element.properties) {
        if (!isCorners(property)) {
          skip(property);
          continue;
        }
        const double count = number(*property.count);
        demand(count >= 3, "face {} has {} corners, must be 3 or more", f, count);
        std::uint32_t first = 0, last = 0;
        for (double k = 0; k < count; ++k) {
          const double index = number(property.type);
          demand(index >= 0 && index <= 4294967295.0 && index == std::floor(index),
                 "face {} has the invalid vertex index {}", f, index);
          const auto corner = std::uint32_t(index);
          if (k == 0) first = corner;
          if (k >= 2) mesh.triangles.emplace_back(first, last, corner);
          last = corner;
        }
      }
  }

  std::string path_;
  std::vector<std::byte> bytes_;
  std::size_t at_ = 0;
  bool ascii_ = false, swapped_ = false;
  std::vector<Element> elements_;
};

}  // namespace

TriangleMesh readPly(const fs::path& path) {
  return PlyReader(path).read();
}

}  // namespace ibr
