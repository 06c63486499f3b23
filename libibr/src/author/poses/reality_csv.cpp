// SPDX-License-Identifier: Apache-2.0
// Reads "Internal/External camera parameters" of RealityScan and RealityCapture. World axes: x east, y north, z up. A
// camera with heading (yaw), pitch and roll 0 looks down, its top to the north. Its axes (libibr's) are turned by the
// roll about y, by the pitch about x, and clockwise by the heading about z.
#include <algorithm>
#include <array>
#include <glm/gtc/quaternion.hpp>
#include <glm/trigonometric.hpp>
#include <map>
#include <utility>

#include "author/poses/pose_source.h"
#include "author/poses/reality_lens.h"
#include "base/check.h"
#include "base/parse.h"

namespace ibr {
namespace {

struct Line {
  std::size_t number;
  std::vector<std::string_view> cells;
};

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\"");
  return first == text.npos ? std::string_view() : text.substr(first, text.find_last_not_of(" \t\r\"") - first + 1);
}

// Lines with content, up to `maxCount`.
std::vector<Line> linesOf(std::string_view text, std::size_t maxCount) {
  std::vector<Line> lines;
  if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
  for (std::size_t number = 1; !text.empty() && lines.size() < maxCount; ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (trimmed(line).empty()) continue;
    Line parsed{number, {}};
    for (std::size_t comma; (comma = line.find(',')) != line.npos; line.remove_prefix(comma + 1))
      parsed.cells.push_back(trimmed(line.substr(0, comma)));
    parsed.cells.push_back(trimmed(line));
    lines.push_back(std::move(parsed));
  }
  return lines;
}

using Columns = std::map<std::string, std::size_t>;

// Names of RealityScan 2, and those of RealityCapture.
constexpr std::array<std::pair<std::string_view, std::string_view>, 4> kOtherNames{
    {{"yaw", "heading"}, {"f_35mm", "f"}, {"px_norm", "px"}, {"py_norm", "py"}}};

// Columns of a header with a camera's pose and focal length; empty if it is none.
Columns columnsOf(const Line& header) {
  Columns columns;
  for (std::size_t i = 0; i < header.cells.size(); ++i) {
    std::string name(header.cells[i]);
    if (name.starts_with('#')) name = name.substr(1);
    for (char& c : name)
      if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
    for (const auto& [newName, oldName] : kOtherNames)
      if (name == newName) name = oldName;
    columns.emplace(name, i);
  }
  for (const char* required : {"name", "x", "y", "alt", "heading", "pitch", "roll", "f"})
    if (!columns.contains(required)) return {};
  return columns;
}

// The header is the first line, or follows "#cameras N".
std::size_t headerOf(const std::vector<Line>& lines) {
  for (std::size_t i = 0; i < std::min(lines.size(), std::size_t(2)); ++i)
    if (!columnsOf(lines[i]).empty()) return i;
  return lines.size();
}

}  // namespace

bool isRealityCsv(const PoseSource& source) {
  const std::vector<Line> lines = linesOf(std::string_view(source.text).substr(0, 4096), 2);
  return headerOf(lines) < lines.size();
}

PosedModel readRealityCsv(PoseSource& source) {
  const std::vector<Line> lines = linesOf(source.text, source.text.size());
  const std::size_t header = headerOf(lines);
  const Columns columns = columnsOf(lines[header]);
  PosedModel model;
  std::size_t divisions = 0;
  for (std::size_t i = header + 1; i < lines.size(); ++i) {
    const Line& line = lines[i];
    if (line.cells[0].starts_with('#')) continue;
    const auto fault = [&](ErrorCode code, const std::string& message) {
      fail(code, "{}:{}: {}: {}", source.path.string(), line.number, line.cells[columns.at("name")], message);
    };
    check(line.cells.size() == lines[header].cells.size(), ErrorCode::invalidInput, "{}:{}: has {} columns, not {}",
          source.path.string(), line.number, line.cells.size(), lines[header].cells.size());
    const auto value = [&](const char* name) {
      const auto column = columns.find(name);
      if (column == columns.end()) return 0.0;
      const std::string_view text = line.cells[column->second];
      const auto number = parseDouble(text);
      if (!number)
        fault(ErrorCode::invalidInput, fmt::format("{} \"{}\" is not a finite number", name, text.substr(0, 40)));
      return *number;
    };
    PosedImage image;
    image.name = std::string(line.cells[columns.at("name")]);
    if (image.name.empty()) fault(ErrorCode::invalidInput, "name is empty");
    const glm::dquat heading = glm::angleAxis(glm::radians(-value("heading")), glm::dvec3(0, 0, 1));
    const glm::dquat pitch = glm::angleAxis(glm::radians(value("pitch")), glm::dvec3(1, 0, 0));
    const glm::dquat roll = glm::angleAxis(glm::radians(value("roll")), glm::dvec3(0, 1, 0));
    image.camera.pose = {{value("x"), value("y"), value("alt")}, glm::normalize(heading * pitch * roll)};
    RealityLens lens{value("f"),
                     value("px"),
                     value("py"),
                     {value("k1"), value("k2"), value("k3"), value("k4"), value("t1"), value("t2")}};
    const bool onlyK1 = std::all_of(lens.terms.begin() + 1, lens.terms.end(), [](double term) { return term == 0; });
    if (onlyK1 && lens.terms[0] != 0) {  // of RealityScan's models, only the division model has one term
      std::swap(lens.division, lens.terms[0]);
      ++divisions;
    }
    setRealityLens(image, source.sizeOf(image.name), lens, source.border, fault);
    model.images.push_back(std::move(image));
  }
  if (model.images.empty())
    fail(ErrorCode::invalidInput, "{}:{}: no camera follows the header", source.path.string(), lines[header].number);
  if (divisions > 0)
    source.warn(
        fmt::format("{} cameras have only k1, which is read as the division model; CSV does not name the model, XMP "
                    "files do",
                    divisions));
  return model;
}

}  // namespace ibr
