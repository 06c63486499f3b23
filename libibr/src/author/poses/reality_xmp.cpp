// SPDX-License-Identifier: Apache-2.0
// Reads a folder of XMP sidecars of RealityScan and RealityCapture, one for each photograph, of the same stem. Camera
// axes: x right, y down, z forward; camera = R·(world − position). Values are attributes or elements.
#include <algorithm>
#include <set>

#include "author/geometry/world_to_camera.h"
#include "author/poses/pose_source.h"
#include "author/poses/reality_lens.h"
#include "author/poses/xml_file.h"
#include "base/check.h"
#include "base/file.h"

namespace ibr {
namespace fs = std::filesystem;
namespace {

constexpr const char* kNamespace = "http://www.capturingreality.com/ns/xcr";
constexpr std::uint64_t kMaxBytes = 1 << 20;  // of a sidecar, which has about 1 KB

bool isXmp(const fs::path& file) {
  std::string extension = file.extension().string();
  for (char& c : extension)
    if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
  return extension == ".xmp";
}

// Text of a sidecar; empty for XMP of other programs.
std::string sidecarText(const fs::path& file) {
  std::error_code ignored;
  if (fs::file_size(file, ignored) > kMaxBytes) return {};
  std::string text = readTextFile(file, kMaxBytes);
  return text.find(kNamespace) == text.npos ? std::string() : text;
}

// The element that has the value, and its text; null if it is missing.
struct Value {
  pugi::xml_node node;
  std::string_view text;
};
std::optional<Value> find(pugi::xml_node description, const char* name) {
  const std::string qualified = std::string("xcr:") + name;
  if (const pugi::xml_attribute attribute = description.attribute(qualified.c_str()))
    return Value{description, attribute.value()};
  if (const pugi::xml_node child = description.child(qualified.c_str())) return Value{child, child.child_value()};
  return std::nullopt;
}

std::vector<double> numbers(const XmlFile& xml, pugi::xml_node description, const char* name, std::size_t count) {
  const auto value = find(description, name);
  if (!value) xml.fault(description, std::string("has no xcr:") + name);
  try {
    return xml.numbers(value->node, value->text, count);
  } catch (const Error& e) {
    fail(e.code(), "{} (xcr:{})", e.what(), name);
  }
}

double numberOr(const XmlFile& xml, pugi::xml_node description, const char* name, double otherwise) {
  return find(description, name) ? numbers(xml, description, name, 1)[0] : otherwise;
}

RealityLens lensOf(const XmlFile& xml, pugi::xml_node description) {
  constexpr std::array<std::string_view, 7> kModels{"none",     "perspective", "brown3",  "brown4",
                                                    "brown3t2", "brown4t2",    "division"};
  RealityLens lens{numbers(xml, description, "FocalLength35mm", 1)[0],
                   numberOr(xml, description, "PrincipalPointU", 0),
                   numberOr(xml, description, "PrincipalPointV", 0),
                   {}};
  if (numberOr(xml, description, "Skew", 0) != 0)
    xml.fault(description, "xcr:Skew is not 0; no lens of libibr has skew", ErrorCode::unsupported);
  if (numberOr(xml, description, "AspectRatio", 1) != 1)
    xml.fault(description, "xcr:AspectRatio is not 1; other pixels are not supported", ErrorCode::unsupported);
  const auto named = find(description, "DistortionModel");
  const std::string model(named ? named->text : "perspective");
  if (std::ranges::find(kModels, model) == kModels.end())
    xml.fault(description, "xcr:DistortionModel \"" + model.substr(0, 40) + "\" is not known", ErrorCode::unsupported);
  if (!find(description, "DistortionCoeficients")) return lens;
  const std::vector<double> terms = numbers(xml, description, "DistortionCoeficients", 6);
  const std::size_t ownTerms = model == "division" ? 1 : model.starts_with("brown") ? 6 : 0;
  if (std::any_of(terms.begin() + std::ptrdiff_t(ownTerms), terms.end(), [](double term) { return term != 0; }))
    xml.fault(description, "xcr:DistortionCoeficients has values that are not 0, which the model " + model + " lacks",
              ErrorCode::unsupported);
  if (model == "division")
    lens.division = terms[0];
  else
    std::ranges::copy(terms, lens.terms.begin());
  return lens;
}

// Adds the sidecar's image; false if it holds no pose.
bool addImage(const fs::path& file, const std::string& text, const std::string& name, PoseSource& source,
              PosedModel& model) {
  const XmlFile xml(file, text);
  pugi::xml_node description = xml.root();
  for (const char* step : {"rdf:RDF", "rdf:Description"})
    if (std::string_view(description.name()) != step) description = xml.child(description, step);
  if (!find(description, "Rotation") && !find(description, "Position")) return false;
  PosedImage image;
  image.name = name;
  const std::vector<double> rotation = numbers(xml, description, "Rotation", 9);
  const std::vector<double> position = numbers(xml, description, "Position", 3);
  std::array<double, 9> rows{};
  std::ranges::copy(rotation, rows.begin());
  const glm::dmat3 matrix = matrixOfRows(rows);
  if (const auto fault = rotationFault(matrix)) xml.fault(description, "xcr:Rotation " + *fault);
  const glm::dquat toCamera = rotationOf(matrix);
  image.camera.pose = poseFromWorldToCamera(toCamera, -(toCamera * glm::dvec3(position[0], position[1], position[2])));
  setRealityLens(image, source.sizeOf(name), lensOf(xml, description), source.border,
                 [&](ErrorCode code, const std::string& message) { xml.fault(description, message, code); });
  model.images.push_back(std::move(image));
  return true;
}

std::vector<fs::path> sidecarsIn(const fs::path& folder) {
  std::vector<fs::path> files;
  std::error_code ignored;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder, ignored))
    if (entry.is_regular_file(ignored) && isXmp(entry.path())) files.push_back(entry.path());
  std::ranges::sort(files);
  return files;
}

}  // namespace

bool isRealityXmp(const PoseSource& source) {
  std::error_code ignored;
  if (!fs::is_directory(source.path, ignored)) return false;
  for (const fs::path& file : sidecarsIn(source.path))
    if (!sidecarText(file).empty()) return true;
  return false;
}

PosedModel readRealityXmp(PoseSource& source) {
  PosedModel model;
  std::size_t without = 0;
  for (const fs::path& file : sidecarsIn(source.path)) {
    const std::string text = sidecarText(file);
    if (text.empty()) continue;
    const std::string name = file.lexically_relative(source.path).replace_extension().generic_string();
    if (!addImage(file, text, name, source, model)) ++without;
  }
  check(!model.images.empty(), ErrorCode::invalidInput, "{}: none of {} XMP files has xcr:Rotation and xcr:Position",
        source.path.string(), without);
  if (without > 0) source.warn(fmt::format("{} XMP files hold no pose", without));
  return model;
}

}  // namespace ibr
