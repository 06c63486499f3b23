// SPDX-License-Identifier: Apache-2.0
// Reads the cameras of Metashape and PhotoScan as XML. A camera's transform maps its axes (x right, y down, z forward)
// to the chunk; the transform of the chunk, or of the camera's component, maps these to the world. The formulas of
// sensors are those of the Metashape manual, appendix "Camera models": P1 and P2 are OpenCV's p2 and p1.
#include <cstring>
#include <map>

#include "author/geometry/world_to_camera.h"
#include "author/poses/pose_source.h"
#include "author/poses/xml_file.h"
#include "base/check.h"

namespace ibr {
namespace {

constexpr auto kUnsupported = ErrorCode::unsupported;

void demandZero(const XmlFile& xml, pugi::xml_node parent, std::initializer_list<const char*> names,
                const std::string& type) {
  for (const char* name : names)
    if (xml.numberOr(parent, name, 0) != 0)
      xml.fault(parent.child(name), "is not 0; no lens of libibr has this term of type " + type, kUnsupported);
}

pugi::xml_node calibrationOf(pugi::xml_node sensor) {
  const pugi::xml_node adjusted = sensor.find_child_by_attribute("calibration", "class", "adjusted");
  return adjusted ? adjusted : sensor.child("calibration");
}

void demandNoRollingShutter(const XmlFile& xml, pugi::xml_node node) {
  for (const pugi::xml_node child : node.children()) {
    const bool isProperty = std::strcmp(child.name(), "property") == 0;
    const std::string_view name = isProperty ? child.attribute("name").value() : child.name();
    if (!name.starts_with("rolling_shutter") || name.ends_with("_covariance")) continue;
    const std::string_view value = isProperty ? child.attribute("value").value() : child.child_value();
    if (value.find_first_not_of("0. \t\r\n") != value.npos && value != "false" && value != "disabled")
      xml.fault(child, "rolling shutter is compensated, which no lens of libibr does", kUnsupported);
  }
}

void setCamera(PosedImage& image, const XmlFile& xml, pugi::xml_node sensor, Border border) {
  const pugi::xml_node calibration = calibrationOf(sensor);
  std::string type = calibration.attribute("type").value();
  if (type.empty()) type = xml.attribute(sensor, "type");
  const pugi::xml_node resolution =
      calibration.child("resolution") ? calibration.child("resolution") : xml.child(sensor, "resolution");
  const int width = xml.integer(resolution, "width", 1, kMaxPoseImageSide);
  const int height = xml.integer(resolution, "height", 1, kMaxPoseImageSide);
  demandNoRollingShutter(xml, sensor);
  try {
    if (type == "spherical") return setPanorama(image, width, height);
  } catch (const Error& e) {
    xml.fault(sensor, e.what(), e.code());
  }
  if (type != "frame" && type != "fisheye")
    xml.fault(calibration ? calibration : sensor, "type \"" + type + "\" is none of frame, fisheye, spherical",
              kUnsupported);
  if (!calibration) xml.fault(sensor, "has no <calibration>");
  if (calibration.child("fx"))
    xml.fault(calibration.child("fx"), "calibrations with fx and fy, of PhotoScan before 1.2, are not supported",
              kUnsupported);
  const auto n = [&](const char* name) { return xml.numberOr(calibration, name, 0); };
  demandZero(xml, calibration, {"b2", "skew", "p3", "p4"}, type);
  if (type == "frame") demandZero(xml, calibration, {"k4"}, type);
  const double f = xml.number(xml.child(calibration, "f"));
  const PinholeTerms k{f + n("b1"), f, 0.5 * width + n("cx"), 0.5 * height + n("cy")};
  const double p1 = n("p2"), p2 = n("p1");  // in OpenCV's order
  try {
    if (type == "frame")
      setBrownLens(image, width, height, k, {n("k1"), n("k2"), n("k3"), p1, p2}, border);
    else
      setLens(image, LensModel::thinPrismFisheye, width, height,
              {k.fx, k.fy, k.cx, k.cy, n("k1"), n("k2"), p1, p2, n("k3"), n("k4"), 0, 0}, border);
  } catch (const Error& e) {
    xml.fault(calibration, e.what(), e.code());
  }
}

glm::dquat rotationAt(const XmlFile& xml, pugi::xml_node node, const glm::dmat3& matrix) {
  if (const auto fault = rotationFault(matrix)) xml.fault(node, *fault);
  return rotationOf(matrix);
}

// Chunk to world; the identity without <transform>.
SimilarityTransform transformOf(const XmlFile& xml, pugi::xml_node node) {
  SimilarityTransform transform;
  const pugi::xml_node found = node.child("transform");
  if (const pugi::xml_node rotation = found.child("rotation")) {
    const std::vector<double> values = xml.numbers(rotation, rotation.child_value(), 9);
    std::array<double, 9> rows{};
    std::copy(values.begin(), values.end(), rows.begin());
    transform.rotation = rotationAt(xml, rotation, matrixOfRows(rows));
  }
  if (const pugi::xml_node shift = found.child("translation")) {
    const std::vector<double> values = xml.numbers(shift, shift.child_value(), 3);
    transform.shift = {values[0], values[1], values[2]};
  }
  transform.scale = xml.numberOr(found, "scale", 1);
  if (!(transform.scale > 0)) xml.fault(found.child("scale"), "is not positive");
  return transform;
}

Pose poseOf(const XmlFile& xml, pugi::xml_node transform) {
  const std::vector<double> m = xml.numbers(transform, transform.child_value(), 16);
  if (!(m[12] == 0 && m[13] == 0 && m[14] == 0 && m[15] == 1)) xml.fault(transform, "the last row is not 0 0 0 1");
  const glm::dmat3 matrix = matrixOfRows({m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]});
  const glm::dquat toCamera = glm::conjugate(rotationAt(xml, transform, matrix));
  return poseFromWorldToCamera(toCamera, -(toCamera * glm::dvec3(m[3], m[7], m[11])));
}

// Cameras, those of groups included.
std::vector<pugi::xml_node> camerasOf(pugi::xml_node chunk) {
  std::vector<pugi::xml_node> cameras;
  for (const pugi::xml_node node : chunk.child("cameras").children()) {
    if (std::strcmp(node.name(), "camera") == 0) cameras.push_back(node);
    if (std::strcmp(node.name(), "group") == 0)
      for (const pugi::xml_node camera : node.children("camera")) cameras.push_back(camera);
  }
  return cameras;
}

std::size_t posedCount(pugi::xml_node chunk) {
  std::size_t count = 0;
  for (const pugi::xml_node camera : camerasOf(chunk)) count += bool(camera.child("transform"));
  return count;
}

pugi::xml_node largestChunk(const XmlFile& xml, const PoseSource& source) {
  const pugi::xml_node root = xml.root();
  if (std::strcmp(root.name(), "chunk") == 0) return root;
  pugi::xml_node largest;
  std::size_t chunks = 0;
  for (const pugi::xml_node chunk : root.children("chunk"))
    if (chunks++ == 0 || posedCount(chunk) > posedCount(largest)) largest = chunk;
  if (!largest) xml.fault(root, "has no <chunk>");
  if (chunks > 1)
    source.warn(fmt::format("has {} chunks; the largest, \"{}\" of {} cameras, is read", chunks,
                            largest.attribute("label").value(), posedCount(largest)));
  return largest;
}

}  // namespace

bool isMetashape(const PoseSource& source) {
  const std::string_view head = std::string_view(source.text).substr(0, 4096);
  return head.find('<') != head.npos && head.find("<chunk") != head.npos &&
         (head.find("<sensors") != head.npos || head.find("<document") != head.npos);
}

PosedModel readMetashape(PoseSource& source) {
  const XmlFile xml(source.path, source.text);
  const pugi::xml_node chunk = largestChunk(xml, source);
  std::map<std::string, pugi::xml_node> sensors, components;
  for (const pugi::xml_node sensor : xml.child(chunk, "sensors").children("sensor"))
    sensors.emplace(xml.attribute(sensor, "id"), sensor);
  for (const pugi::xml_node component : chunk.child("components").children("component"))
    components.emplace(xml.attribute(component, "id"), component);
  const std::vector<pugi::xml_node> cameras = camerasOf(chunk);
  std::map<std::string, std::size_t> posedIn;  // cameras with a pose, of each component
  for (const pugi::xml_node camera : cameras)
    if (camera.child("transform")) ++posedIn[camera.attribute("component_id").value()];
  std::string component;
  for (const auto& [id, count] : posedIn)
    if (posedIn.find(component) == posedIn.end() || count > posedIn[component]) component = id;
  if (posedIn.size() > 1)
    source.warn(fmt::format("has cameras of {} components; the largest, of {} cameras, is read", posedIn.size(),
                            posedIn[component]));
  const auto found = components.find(component);
  const bool hasOwn = found != components.end() && found->second.child("transform");
  const SimilarityTransform toWorld = transformOf(xml, hasOwn ? found->second : chunk);
  PosedModel model;
  for (const pugi::xml_node camera : cameras) {
    const pugi::xml_node transform = camera.child("transform");
    if (!transform || camera.attribute("component_id").value() != component) continue;
    PosedImage image;
    image.name = std::string(xml.attribute(camera, "label"));
    if (image.name.empty()) xml.fault(camera, "the label is empty");
    const auto sensor = sensors.find(std::string(xml.attribute(camera, "sensor_id")));
    if (sensor == sensors.end())
      xml.fault(camera, "has no sensor " + std::string(xml.attribute(camera, "sensor_id")) + " in the file");
    demandNoRollingShutter(xml, camera);
    setCamera(image, xml, sensor->second, source.border);
    image.camera.pose = toWorld(poseOf(xml, transform));
    model.images.push_back(std::move(image));
  }
  if (model.images.empty()) xml.fault(chunk, "has no camera with a <transform>");
  if (model.images.size() < cameras.size())
    source.warn(
        fmt::format("{} of {} cameras are not registered", cameras.size() - model.images.size(), cameras.size()));
  return model;
}

}  // namespace ibr
