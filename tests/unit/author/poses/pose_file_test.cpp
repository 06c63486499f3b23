// SPDX-License-Identifier: Apache-2.0
// Poses of other programs: exact cameras are written by the formats' definitions, and read. Each file is named "poses",
// without an extension.
#include <catch2/catch.hpp>
#include <cstdlib>
#include <functional>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "ibr/author/poses.h"
#include "ibr/error.h"
#include "support/json.h"
#include "support/temporary_folder.h"
#include "unit/author/poses/posed_truth.h"

namespace fs = std::filesystem;
using namespace ibr;
using namespace ibr::test;
using Catch::Contains;
using Json = nlohmann::json;

namespace {

constexpr double kMaxErrorPx = 1e-6;         // files hold all digits
constexpr double kMaxMeasurementPx = 0.001;  // COLMAP writes measurements with 6 digits

using Cameras = std::vector<ExactCamera>;

// Points that all cameras see.
std::vector<glm::dvec3> commonPoints(const Cameras& cameras) {
  std::vector<glm::dvec3> common;
  for (const ExactCamera& camera : cameras)
    for (const glm::dvec3& point : camera.seenPoints(5)) common.push_back(point);
  return common;
}

bool sees(const ExactCamera& camera, glm::dvec3 world) {
  const glm::dvec3 p = camera.toCamera * (world - camera.centre);
  const glm::dvec2 at = camera.pixel(world);
  return p.z > 0.75 * glm::length(p) && at.x > 40 && at.y > 40 && at.x < camera.width - 40 && at.y < camera.height - 40;
}

std::string bundle(const Cameras& cameras) {
  const auto points = commonPoints(cameras);
  std::string text = fmt::format("# Bundle file v0.3\n{} {}\n", cameras.size() + 1, points.size());
  for (const ExactCamera& c : cameras) {
    text += fmt::format("{} {} {}\n", c.fx, c.k1, c.k2);
    for (int i = 0; i < 3; ++i)
      text += fmt::format("{} {} {}\n", (i ? -1 : 1) * c.r(i, 0), (i ? -1 : 1) * c.r(i, 1), (i ? -1 : 1) * c.r(i, 2));
    const glm::dvec3 t = c.translation();
    text += fmt::format("{} {} {}\n", t.x, -t.y, -t.z);
  }
  text += "0 0 0\n0 0 0\n0 0 0\n0 0 0\n0 0 0\n";  // not registered
  for (const glm::dvec3& p : points) {
    std::string views;
    std::size_t count = 0;
    for (std::size_t i = 0; i < cameras.size(); ++i)
      if (sees(cameras[i], p)) {
        const glm::dvec2 at = cameras[i].pixel(p);
        views += fmt::format(" {} {} {} {}", i, count++, at.x - cameras[i].cx, cameras[i].cy - at.y);
      }
    text += fmt::format("{} {} {}\n255 0 7\n{}{}\n", p.x, p.y, p.z, count, views);
  }
  return text;
}

std::string nameList(const Cameras& cameras) {
  std::string text;
  for (const ExactCamera& c : cameras) text += fmt::format("./{} 0 {}\n", c.name, c.fx);
  return text + "lost.png\n";
}

std::string nvm(const Cameras& cameras, bool fixed) {
  const auto points = commonPoints(cameras);
  const ExactCamera& first = cameras[0];
  std::string text =
      "NVM_V3" +
      (fixed ? fmt::format(" FixedK {} {} {} {} 0", first.fx, first.cx, first.fy, first.cy) : std::string()) +
      fmt::format("\n\n{}\n", cameras.size());
  for (const ExactCamera& c : cameras)
    text += fmt::format("{}\t{} {} {} {} {} {} {} {} 0 0\n", c.name, c.fx, c.toCamera.w, c.toCamera.x, c.toCamera.y,
                        c.toCamera.z, c.centre.x, c.centre.y, c.centre.z);
  text += fmt::format("\n{}\n", points.size());
  for (const glm::dvec3& p : points) {
    std::string views;
    std::size_t count = 0;
    for (std::size_t i = 0; i < cameras.size(); ++i)
      if (sees(cameras[i], p)) {
        const glm::dvec2 at = cameras[i].pixel(p);
        views += fmt::format(" {} {} {} {}", i, count++, at.x - cameras[i].cx, at.y - cameras[i].cy);
      }
    text += fmt::format("{} {} {} 255 0 7 {}{}\n", p.x, p.y, p.z, count, views);
  }
  return text + "\n0\n\n#the last part of NVM file points to the PLY files\n0\n";
}

Json rowsOf(const ExactCamera& c) {
  Json rows = Json::array();
  for (int i = 0; i < 3; ++i) rows.push_back({c.r(i, 0), c.r(i, 1), c.r(i, 2)});
  return rows;
}

// A type's name stands at its first occurrence, as cereal writes it.
Json openMvg(const Cameras& cameras, const std::string& type) {
  Json json{{"sfm_data_version", "0.3"}, {"root_path", "/elsewhere"}, {"views", Json::array()}};
  json["intrinsics"] = json["extrinsics"] = json["structure"] = json["control_points"] = Json::array();
  constexpr std::uint64_t kFirst = 2147483648;
  std::uint64_t id = 0;
  for (std::size_t i = 0; i <= cameras.size(); ++i) {  // the last view has no pose
    const std::string name = i < cameras.size() ? cameras[i].name : "lost.png";
    json["views"].push_back({{"key", i},
                             {"value",
                              {{"polymorphic_id", 1073741824},
                               {"ptr_wrapper",
                                {{"id", kFirst + ++id},
                                 {"data",
                                  {{"local_path", ""},
                                   {"filename", name},
                                   {"width", 640},
                                   {"height", 480},
                                   {"id_view", i},
                                   {"id_intrinsic", std::min(i, cameras.size() - 1)},
                                   {"id_pose", i + 10}}}}}}}});
  }
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const ExactCamera& c = cameras[i];
    Json base{{"width", c.width}, {"height", c.height}};
    if (type != "spherical") base["focal_length"] = c.fx, base["principal_point"] = {c.cx, c.cy};
    Json data = base;
    if (type == "spherical" || type == "fisheye" || type == "pinhole_brown_t2") data = {{"value0", base}};
    if (type == "pinhole_radial_k1") data["disto_k1"] = {c.k1};
    if (type == "pinhole_radial_k3") data["disto_k3"] = {c.k1, c.k2, c.k3};
    if (type == "pinhole_brown_t2") data["disto_t2"] = {c.k1, c.k2, c.k3, c.p1, c.p2};
    if (type == "fisheye") data["fisheye"] = {c.k1, c.k2, c.k3, c.k4};
    Json value{{"polymorphic_id", i == 0 ? kFirst + 1 : 1}, {"ptr_wrapper", {{"id", kFirst + ++id}, {"data", data}}}};
    if (i == 0) value["polymorphic_name"] = type;
    json["intrinsics"].push_back({{"key", i}, {"value", value}});
    json["extrinsics"].push_back(
        {{"key", i + 10}, {"value", {{"rotation", rowsOf(c)}, {"center", {c.centre.x, c.centre.y, c.centre.z}}}}});
  }
  const auto points = commonPoints(cameras);
  for (std::size_t p = 0; p < points.size() && type != "spherical"; ++p) {
    Json observations = Json::array();
    for (std::size_t i = 0; i < cameras.size(); ++i)
      if (const glm::dvec2 at = cameras[i].pixel(points[p]); sees(cameras[i], points[p]))
        observations.push_back({{"key", i}, {"value", {{"id_feat", p}, {"x", {at.x, at.y}}}}});
    json["structure"].push_back(
        {{"key", p}, {"value", {{"X", {points[p].x, points[p].y, points[p].z}}, {"observations", observations}}}});
  }
  return json;
}

Json openSfm(const Cameras& cameras, const std::string& type) {
  Json one{{"cameras", Json::object()}, {"shots", Json::object()}, {"points", Json::object()}};
  for (const ExactCamera& c : cameras) {
    const double side = std::max(c.width, c.height), angle = 2 * std::acos(std::clamp(c.toCamera.w, -1.0, 1.0));
    const glm::dvec3 axis = glm::normalize(glm::dvec3(c.toCamera.x, c.toCamera.y, c.toCamera.z));
    Json camera{{"projection_type", type}, {"width", c.width}, {"height", c.height}};
    if (type == "perspective" || type == "fisheye" || type == "dual")
      camera.update({{"focal", c.fx / side}, {"k1", c.k1}, {"k2", c.k2}});
    if (type == "dual") camera["transition"] = c.kind == ExactCamera::fisheye ? 0.0 : 1.0;
    if (type != "perspective" && type != "fisheye" && type != "dual" && type != "spherical")
      camera.update({{"focal_x", c.fx / side},
                     {"focal_y", c.fy / side},
                     {"c_x", (c.cx - 0.5 * c.width) / side},
                     {"c_y", (c.cy - 0.5 * c.height) / side},
                     {"k1", c.k1}});
    if (type == "radial") camera["k2"] = c.k2;
    if (type == "brown") camera.update({{"k2", c.k2}, {"k3", c.k3}, {"p1", c.p1}, {"p2", c.p2}});
    if (type == "fisheye_opencv") camera.update({{"k2", c.k2}, {"k3", c.k3}, {"k4", c.k4}});
    if (type == "fisheye62" || type == "fisheye624")
      camera.update({{"k2", c.k2}, {"k3", c.k3}, {"k4", c.k4}, {"k5", 0.0}, {"k6", 0.0}, {"p1", c.p1}, {"p2", c.p2}});
    if (type == "fisheye624") camera.update({{"s0", c.s1}, {"s1", 0.0}, {"s2", c.s2}, {"s3", 0.0}});
    const glm::dvec3 t = c.translation();
    one["cameras"]["of " + c.name] = camera;
    one["shots"][c.name] = {{"camera", "of " + c.name},
                            {"rotation", {angle * axis.x, angle * axis.y, angle * axis.z}},
                            {"translation", {t.x, t.y, t.z}},
                            {"gps_position", {0, 0, 0}}};
  }
  const auto points = commonPoints(cameras);
  for (std::size_t p = 0; p < points.size(); ++p)
    one["points"][std::to_string(p)] = {{"color", {1, 2, 3}}, {"coordinates", {points[p].x, points[p].y, points[p].z}}};
  return Json::array({one});
}

std::string tracksCsv(const Cameras& cameras) {
  std::string text = "OPENSFM_TRACKS_VERSION_v2\n";
  const auto points = commonPoints(cameras);
  for (const ExactCamera& c : cameras)
    for (std::size_t p = 0; p < points.size(); ++p)
      if (const glm::dvec2 at = c.pixel(points[p]); sees(c, points[p]))
        text += fmt::format("{}\t{}\t{}\t{}\t{}\t0.004\t1\t2\t3\t-1\t-1\n", c.name, p, p,
                            (at.x - 0.5 * c.width) / std::max(c.width, c.height),
                            (at.y - 0.5 * c.height) / std::max(c.width, c.height));
  return text + "lost.png\t0\t0\t0.1\t0.1\t0.004\t1\t2\t3\t-1\t-1\n";
}

// World = 2.5·S·chunk + (7, −8, 9), with S a turn by 0.8 about (1, 1, 0).
const glm::dquat kChunkTurn = glm::angleAxis(0.8, glm::normalize(glm::dvec3(1, 1, 0)));
std::string metashape(const Cameras& cameras, const std::string& type) {
  std::string text =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<document version=\"1.5.0\">\n<chunk label=\"Chunk 1\">\n"
      "<sensors next_id=\"9\">\n";
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const ExactCamera& c = cameras[i];
    text += fmt::format("<sensor id=\"{}\" label=\"x\" type=\"{}\">\n<resolution width=\"{}\" height=\"{}\"/>\n", i,
                        type, c.width, c.height);
    if (type != "spherical")
      text += fmt::format(
          "<calibration type=\"{0}\" class=\"initial\"><f>1</f></calibration>\n"
          "<calibration type=\"{0}\" class=\"adjusted\">\n<resolution width=\"{1}\" height=\"{2}\"/>\n"
          "<f>{3}</f>\n<cx>{4}</cx>\n<cy>{5}</cy>\n<b1>{6}</b1>\n<b2>0</b2>\n<k1>{7}</k1>\n<k2>{8}</k2>\n"
          "<k3>{9}</k3>\n<k4>{10}</k4>\n<p1>{11}</p1>\n<p2>{12}</p2>\n</calibration>\n",
          type, c.width, c.height, c.fy, c.cx - 0.5 * c.width, c.cy - 0.5 * c.height, c.fx - c.fy, c.k1, c.k2, c.k3,
          c.k4, c.p2, c.p1);
    text += "</sensor>\n";
  }
  text += "</sensors>\n<cameras next_id=\"9\">\n<camera id=\"90\" sensor_id=\"0\" label=\"lost\"/>\n";
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const glm::dquat inChunk = glm::conjugate(kChunkTurn) * glm::conjugate(cameras[i].toCamera);
    const glm::dvec3 at = glm::conjugate(kChunkTurn) * ((cameras[i].centre - glm::dvec3(7, -8, 9)) / 2.5);
    const glm::dmat3 m = glm::mat3_cast(inChunk);
    std::string matrix;
    for (int r = 0; r < 3; ++r) matrix += fmt::format("{} {} {} {} ", m[0][r], m[1][r], m[2][r], at[r]);
    const std::string label = fs::path(cameras[i].name).stem().string();
    const std::string camera = fmt::format(
        "<camera id=\"{0}\" sensor_id=\"{0}\" label=\"{1}\">\n<transform>{2}0 0 0 1"
        "</transform>\n<orientation>1</orientation>\n</camera>\n",
        i, label, matrix);
    text += i == 1 ? "<group id=\"0\" label=\"g\">\n" + camera + "</group>\n" : camera;
  }
  const glm::dmat3 s = glm::mat3_cast(kChunkTurn);
  text += "</cameras>\n<transform>\n<rotation locked=\"true\">";
  for (int i = 0; i < 9; ++i) text += fmt::format("{} ", s[i % 3][i / 3]);
  return text +
         "</rotation>\n<translation>7 -8 9</translation>\n<scale>2.5</scale>\n</transform>\n</chunk>\n</document>\n";
}

// Angles whose rotation is R = rows of right, down and forward: forward and down in terms of heading, pitch and roll.
std::string realityCsv(const Cameras& cameras) {
  std::string text = "#cameras 3\n#name,x,y,alt,heading,pitch,roll,f,px,py,k1,k2,k3,k4,t1,t2\n";
  constexpr double kDegree = std::numbers::pi / 180;
  for (const ExactCamera& c : cameras) {
    const double pitch = std::asin(-c.r(1, 2)), heading = std::atan2(-c.r(1, 0), -c.r(1, 1));
    const double roll = std::atan2(-c.r(0, 2), -c.r(2, 2)), side = std::max(c.width, c.height);
    text +=
        fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},0,{},{}\n", c.name, c.centre.x, c.centre.y, c.centre.z,
                    heading / kDegree, pitch / kDegree, roll / kDegree, c.fx * 36 / side, (c.cx - 0.5 * c.width) / side,
                    (c.cy - 0.5 * c.height) / side, c.k1 + c.division, c.k2, c.k3, c.p2, c.p1);
  }
  return text;
}

std::string xmp(const ExactCamera& c, const std::string& model, bool attributes) {
  const double side = std::max(c.width, c.height);
  const std::string terms = fmt::format("{} {} {} 0 {} {}", c.k1 + c.division, c.k2, c.k3, c.p2, c.p1);
  return fmt::format(
      "<x:xmpmeta xmlns:x=\"adobe:ns:meta/\">\n<rdf:RDF xmlns:rdf=\"http://www.w3.org/1999/02/22-rdf-syntax-ns#\">\n"
      "<rdf:Description xcr:Version=\"3\" xcr:PosePrior=\"locked\" xcr:Coordinates=\"absolute\"\n"
      "xcr:DistortionModel=\"{}\" xcr:FocalLength35mm=\"{}\" xcr:Skew=\"0\" xcr:AspectRatio=\"1\"\n"
      "xcr:PrincipalPointU=\"{}\" xcr:PrincipalPointV=\"{}\" {}\n"
      "xmlns:xcr=\"http://www.capturingreality.com/ns/xcr/1.1#\">\n<xcr:Rotation>{}</xcr:Rotation>\n"
      "<xcr:Position>{} {} {}</xcr:Position>\n{}</rdf:Description>\n</rdf:RDF>\n</x:xmpmeta>\n",
      model, c.fx * 36 / side, (c.cx - 0.5 * c.width) / side, (c.cy - 0.5 * c.height) / side,
      attributes ? "xcr:DistortionCoeficients=\"" + terms + "\"" : "", c.rows(" "), c.centre.x, c.centre.y, c.centre.z,
      attributes ? "" : "<xcr:DistortionCoeficients>" + terms + "</xcr:DistortionCoeficients>\n");
}

Cameras with(Cameras cameras, const std::function<void(ExactCamera&)>& change) {
  for (ExactCamera& camera : cameras) change(camera);
  return cameras;
}

void brownTerms(ExactCamera& c) {
  c.cx += 7.25, c.cy -= 4.5;
  c.k1 = -0.12, c.k2 = 0.04, c.k3 = -0.006, c.p1 = 0.0012, c.p2 = -0.0023;
}
void fisheyeTerms(ExactCamera& c) {
  c.kind = ExactCamera::fisheye, c.fx = c.fy = 280;
  c.cx += 3.5, c.cy -= 2.25;
  c.k1 = -0.03, c.k2 = 0.008, c.k3 = -0.002, c.k4 = 0.0003;
}
void sphere(ExactCamera& c) {
  c.kind = ExactCamera::spherical, c.width = 512, c.height = 256;
}

// A folder with photographs, and a file of poses beside them.
struct Files {
  TemporaryFolder folder;
  fs::path file = folder / "poses", photographs = folder / "photographs";
  std::vector<std::string> messages;

  explicit Files(const Cameras& cameras) { writePhotographs(photographs, cameras); }
  PosedModel read() {
    return readPoseFile(file, photographs, [&](LogLevel, std::string_view text) { messages.emplace_back(text); });
  }
  PosedModel read(const std::string& text) {
    writeFile(file, text);
    return read();
  }
  std::string faultOf(const std::string& text, ErrorCode code = ErrorCode::invalidInput) {
    try {
      read(text);
    } catch (const Error& e) {
      INFO(e.what());
      CHECK(e.code() == code);
      CHECK_THAT(e.what(), Contains(file.string()));
      return e.what();
    }
    FAIL_CHECK("nothing was thrown");
    return {};
  }
  /// No start of the text, and no text with one damaged byte, may end otherwise than in a model or in an Error.
  void damage(const std::string& text) {
    for (std::size_t i = 0; i < 100; ++i) {
      std::string damaged = i % 2 ? text.substr(0, text.size() * i / 100) : text;
      if (i % 2 == 0) damaged[text.size() * i / 100] = "9x<{\0-,]"[i / 2 % 8];
      try {
        read(damaged);
      } catch (const Error& e) {
        CHECK_THAT(e.what(), Contains(folder.path().string()));
      }
    }
  }
};

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  INFO(from);
  REQUIRE(at != text.npos);
  return text.replace(at, from.size(), to);
}

void checkExact(const PosedModel& model, const Cameras& cameras, bool tracks) {
  REQUIRE(model.images.size() == cameras.size());
  const double error = projectionError(model, cameras);
  UNSCOPED_INFO("largest projection error " << error << " px");
  CHECK(error < kMaxErrorPx);
  if (std::getenv("IBR_TEST_FIGURES")) WARN("largest projection error " << error << " px");
  if (!tracks) return;
  CHECK(model.tracks.size() >= 5);
  CHECK(trackError(model) < kMaxMeasurementPx);
}

}  // namespace

TEST_CASE("Bundler files give exact cameras and points, with the names of the list beside") {
  const Cameras cameras = with(exactCameras(), [](ExactCamera& c) { c.k1 = -0.1, c.k2 = 0.03; });
  Files files(cameras);
  writeFile(files.folder / "list.txt", nameList(cameras));
  checkExact(files.read(bundle(cameras)), cameras, true);
  CHECK(poseFormatOf(files.file) == PoseFormat::bundler);
  CHECK_THAT(files.messages.at(0), Contains("1 of 4 images are not registered"));

  const std::string text = bundle(cameras);
  CHECK_THAT(files.faultOf(replaced(text, "v0.3", "v0.9"), ErrorCode::unsupported), Contains("poses:1"));
  CHECK_THAT(files.faultOf(replaced(text, "4 15", "4000000000 15")), Contains("number of cameras"));
  CHECK_THAT(files.faultOf(replaced(text, "4 15", "4 2000000000")), Contains("ends before a point"));
  CHECK_THAT(files.faultOf(replaced(text, "500 -0.1", "500 nan")), Contains("poses:3") && Contains("k1"));
  CHECK_THAT(files.faultOf(replaced(text, "500 -0.1", "-500 -0.1")), Contains("sub/a.png"));
  CHECK_THAT(files.faultOf(replaced(text, fmt::format("{}", cameras[0].r(0, 0)), "0")),
             Contains("R of camera 0") && Contains("orthonormal"));
  CHECK_THAT(files.faultOf(text.substr(0, text.size() / 2)), Contains("ends before"));
  files.damage(text);
  writeFile(files.folder / "list.txt", std::string("a.png\n"));
  CHECK_THROWS_WITH(files.read(text), Contains("list.txt") && Contains("1 names"));
  fs::remove(files.folder / "list.txt");
  CHECK_THAT(files.faultOf(text, ErrorCode::io), Contains("list.txt"));
}

TEST_CASE("NVM files give exact cameras and points; measured distortion is refused") {
  const Cameras cameras = exactCameras();
  Files files(cameras);
  checkExact(files.read(nvm(cameras, false)), cameras, true);
  CHECK(poseFormatOf(files.file) == PoseFormat::nvm);
  const Cameras fixed = with(cameras, [](ExactCamera& c) { c.fy = 510, c.cx = 333, c.cy = 230; });
  checkExact(files.read(nvm(fixed, true)), fixed, true);

  const std::string text = nvm(cameras, false);
  const std::string unsupported = files.faultOf(replaced(text, " 0 0\n", " 0.01 0\n"), ErrorCode::unsupported);
  CHECK_THAT(unsupported, Contains("poses:4") && Contains("radial distortion 0.01 of sub/a.png"));
  CHECK_THAT(files.faultOf(replaced(nvm(fixed, true), " 230 0\n", " 230 0.1\n"), ErrorCode::unsupported),
             Contains("FixedK"));
  CHECK_THAT(files.faultOf(replaced(text, fmt::format("{}", cameras[0].toCamera.w), "9")), Contains("quaternion"));
  CHECK_THAT(files.faultOf(replaced(text, "NVM_V3", "NVM_V3 Fixed")), Contains("FixedK"));
  CHECK_THAT(files.faultOf(replaced(text, "\n3\n", "\n2000000000\n")), Contains("poses:"));
  CHECK_THAT(files.faultOf(replaced(text, "255 0 7 1 0", "255 0 7 1 77")), Contains("measurement's image"));
  CHECK_THAT(files.faultOf("NVM_V3\n0\n"), Contains("no camera"));
  files.damage(text);
}

TEST_CASE("COLMAP's converter writes Bundler and NVM files that are read exactly") {
  if (std::system("colmap help > /dev/null 2>&1") != 0) {
    WARN("the program COLMAP is not installed");
    return;
  }
  const Cameras cameras = exactCameras();
  Files files(cameras);
  PosedModel exact;
  for (const ExactCamera& c : cameras) {
    const glm::dquat halfTurn(0, 1, 0, 0);
    exact.images.push_back({c.name,
                            {{CameraModel::pinhole, c.width, c.height, c.fx, c.fy, c.cx, c.cy},
                             {c.centre, glm::conjugate(c.toCamera) * halfTurn}}});
  }
  for (const glm::dvec3& p : commonPoints(cameras)) {
    Track track{p, {}};
    for (std::size_t i = 0; i < cameras.size(); ++i)
      if (sees(cameras[i], p)) track.observations.push_back({std::uint32_t(i), cameras[i].pixel(p)});
    if (!track.observations.empty()) exact.tracks.push_back(track);
  }
  writeColmapModel(exact, files.folder / "model");
  CHECK(readPoseFile(files.folder / "model", files.photographs).images.size() == 3);
  for (const auto& [type, name] : {std::pair("Bundler", "made.bundle.out"), std::pair("NVM", "made.nvm")}) {
    const fs::path output = files.folder / (std::string(type) == "NVM" ? "made.nvm" : "made");
    const std::string command = fmt::format("colmap model_converter --input_path {} --output_path {} --output_type {}",
                                            (files.folder / "model").string(), output.string(), type);
    REQUIRE(std::system((command + " > /dev/null 2>&1").c_str()) == 0);
    files.file = files.folder / name;
    checkExact(files.read(), cameras, true);
  }
}

TEST_CASE("OpenMVG files give exact cameras of all types, and points") {
  const Cameras plain = exactCameras();
  const std::vector<std::pair<std::string, std::function<void(ExactCamera&)>>> types{
      {"pinhole", [](ExactCamera& c) { c.cx += 5; }},
      {"pinhole_radial_k1", [](ExactCamera& c) { c.k1 = -0.1; }},
      {"pinhole_radial_k3", [](ExactCamera& c) { c.k1 = -0.1, c.k2 = 0.03, c.k3 = -0.004, c.cy += 6; }},
      {"pinhole_brown_t2", brownTerms},
      {"fisheye", fisheyeTerms},
      {"spherical", sphere}};
  for (const auto& [type, change] : types) {
    INFO(type);
    const Cameras cameras = with(plain, change);
    Files files(cameras);
    checkExact(files.read(openMvg(cameras, type).dump()), cameras, type != "spherical");
    CHECK(poseFormatOf(files.file) == PoseFormat::openMvg);
    CHECK_THAT(files.messages.at(0), Contains("1 of 4 views have no pose"));
    files.damage(openMvg(cameras, type).dump());
  }
  const Cameras cameras = with(plain, brownTerms);
  Files files(cameras);
  const auto fault = [&](const char* pointer, const Json& value, ErrorCode code = ErrorCode::invalidInput) {
    Json json = openMvg(cameras, "pinhole_brown_t2");
    json[Json::json_pointer(pointer)] = value;
    const std::string text = files.faultOf(json.dump(), code);
    CHECK_THAT(text, Contains(std::string(pointer).substr(0, 15)));
  };
  fault("/intrinsics/0/value/polymorphic_name", "pinhole_magic", ErrorCode::unsupported);
  fault("/intrinsics/0/value/ptr_wrapper/data/disto_t2", Json::array({1, 2}));
  fault("/intrinsics/0/value/ptr_wrapper/data/disto_t2/3", "x");
  fault("/intrinsics/1/value/ptr_wrapper/data/value0/width", 1e9);
  fault("/intrinsics/1/value/ptr_wrapper/data/value0/focal_length", -1);
  fault("/extrinsics/0/value/rotation/0/0", 5);
  fault("/extrinsics/0/value/rotation", Json::array({Json::array({0, 0, 0}), {0, 0, 0}, {0, 0, 0}}));
  fault("/extrinsics/0/value/center", nullptr);
  fault("/views/1/value/ptr_wrapper/data/filename", 3);
  fault("/views/1/value/ptr_wrapper/data/id_intrinsic", 77);
  fault("/structure/0/value/observations/0/value/x", Json::array({1}));
}

TEST_CASE("OpenSfM files give exact cameras of all projections, and points where tracks.csv has them") {
  const Cameras plain = exactCameras();
  const auto radial = [](ExactCamera& c) { c.k1 = -0.1, c.k2 = 0.03; };
  const auto centred = [](ExactCamera& c) {
    fisheyeTerms(c);
    c.cx = 320, c.cy = 240, c.k3 = c.k4 = 0;
  };
  const std::vector<std::pair<std::string, std::function<void(ExactCamera&)>>> types{
      {"perspective", radial},
      {"simple_radial", [](ExactCamera& c) { c.k1 = -0.1, c.fy = 490, c.cx += 9; }},
      {"radial", [&](ExactCamera& c) { radial(c), c.fy = 490, c.cy -= 9; }},
      {"brown", brownTerms},
      {"fisheye", centred},
      {"fisheye_opencv", fisheyeTerms},
      {"fisheye62", [](ExactCamera& c) { fisheyeTerms(c), c.p1 = 0.001, c.p2 = -0.002; }},
      {"fisheye624", [](ExactCamera& c) { fisheyeTerms(c), c.p1 = 0.001, c.p2 = -0.002, c.s1 = 0.003, c.s2 = -0.001; }},
      {"dual", radial},
      {"dual", centred},
      {"spherical", sphere}};
  for (const auto& [type, change] : types) {
    INFO(type);
    const Cameras cameras = with(plain, change);
    Files files(cameras);
    checkExact(files.read(openSfm(cameras, type).dump()), cameras, false);
    CHECK_THAT(files.messages.at(0), Contains("no tracks.csv"));
    if (type != "spherical") {
      writeFile(files.folder / "tracks.csv", tracksCsv(cameras));
      checkExact(files.read(), cameras, true);
    }
    CHECK(poseFormatOf(files.file) == PoseFormat::openSfm);
    files.damage(openSfm(cameras, type).dump());
  }
  const Cameras cameras = with(plain, brownTerms);
  Files files(cameras);
  Json several = openSfm({cameras[0]}, "brown");
  several.push_back(openSfm(cameras, "brown")[0]);
  checkExact(files.read(several.dump()), cameras, false);
  CHECK_THAT(files.messages.at(0), Contains("2 reconstructions") && Contains("3 shots"));

  const auto fault = [&](const char* pointer, const Json& value, ErrorCode code = ErrorCode::invalidInput) {
    Json json = openSfm(cameras, "brown");
    json[Json::json_pointer(pointer)] = value;
    CHECK_THAT(files.faultOf(json.dump(), code), Contains(std::string(pointer).substr(0, 10)));
  };
  fault("/0/cameras/of b.png/projection_type", "fisheye99", ErrorCode::unsupported);
  fault("/0/cameras/of b.png/projection_type", 7);
  fault("/0/cameras/of b.png/k4", 0.1, ErrorCode::unsupported);
  fault("/0/cameras/of b.png/k1", "x");
  fault("/0/cameras/of b.png/width", 1 << 30);
  fault("/0/cameras/of b.png/focal_x", 0);
  fault("/0/shots/b.png/rotation", Json::array({1, 2}));
  fault("/0/shots/b.png/camera", "unknown");
  fault("/0/shots", Json::array());
  for (const auto& [type, term] : {std::pair("fisheye62", "k5"), std::pair("fisheye624", "s1")}) {
    Json json = openSfm(with(plain, fisheyeTerms), type);
    json[0]["cameras"]["of c.png"][term] = 0.01;
    CHECK_THAT(files.faultOf(json.dump(), ErrorCode::unsupported),
               Contains(std::string("/0/cameras/of c.png/") + term));
  }
  Json dual = openSfm(with(plain, radial), "dual");
  dual[0]["cameras"]["of c.png"]["transition"] = 0.5;
  CHECK_THAT(files.faultOf(dual.dump(), ErrorCode::unsupported), Contains("transition"));
  writeFile(files.folder / "tracks.csv", std::string("b.png\t0\t0\tx\t0\n"));
  CHECK_THROWS_WITH(files.read(openSfm(cameras, "brown").dump()), Contains("tracks.csv:1"));
  writeFile(files.folder / "tracks.csv", std::string("b.png\t0\n"));
  CHECK_THROWS_WITH(files.read(), Contains("tracks.csv:1") && Contains("columns"));
}

TEST_CASE("Metashape files give exact cameras of frame, fisheye and spherical sensors") {
  const Cameras plain = exactCameras();
  const std::vector<std::pair<std::string, std::function<void(ExactCamera&)>>> types{
      {"frame", [](ExactCamera& c) { brownTerms(c), c.fx = 503.5; }},
      {"fisheye", [](ExactCamera& c) { fisheyeTerms(c), c.p1 = 0.001, c.p2 = -0.002, c.fx = 281; }},
      {"spherical", sphere}};
  for (const auto& [type, change] : types) {
    INFO(type);
    const Cameras cameras = with(plain, change);
    Files files(cameras);
    checkExact(files.read(metashape(cameras, type)), cameras, false);
    CHECK(poseFormatOf(files.file) == PoseFormat::metashape);
    CHECK_THAT(files.messages.at(0), Contains("1 of 4 cameras are not registered"));
    files.damage(metashape(cameras, type));
  }
  const Cameras cameras = with(plain, brownTerms);
  Files files(cameras);
  const std::string text = metashape(cameras, "frame");
  const auto fault = [&](const std::string& from, const std::string& to, const std::string& field,
                         ErrorCode code = ErrorCode::invalidInput) {
    CHECK_THAT(files.faultOf(replaced(text, from, to), code), Contains("poses:") && Contains(field));
  };
  fault("<k4>0</k4>", "<k4>0.1</k4>", "calibration/k4", ErrorCode::unsupported);
  fault("<b2>0</b2>", "<b2>2</b2>", "calibration/b2", ErrorCode::unsupported);
  fault("<b2>0</b2>", "<p3>2</p3>", "calibration/p3", ErrorCode::unsupported);
  fault("<calibration type=\"frame\" class=\"adjusted\">", "<calibration type=\"cylindrical\" class=\"adjusted\">",
        "cylindrical", ErrorCode::unsupported);
  fault("<f>500</f>", "<fx>500</fx>", "calibration/fx", ErrorCode::unsupported);
  fault("<f>500</f>", "", "calibration: has no <f>");
  fault("<f>500</f>", "<f>inf</f>", "calibration/f");
  fault("<f>500</f>", "<f>0</f>", "calibration");
  fault("<orientation>1</orientation>", "<rolling_shutter>1 2</rolling_shutter>", "rolling shutter",
        ErrorCode::unsupported);
  fault("width=\"640\" height=\"480\"/>\n<f>", "width=\"640000000\" height=\"480\"/>\n<f>", "width");
  fault("0 0 0 1</transform>", "0 0 0</transform>", "camera/transform: has 15 numbers");
  fault("0 0 0 1</transform>", "0 0 1 1</transform>", "last row");
  fault("<transform>", "<transform>7", "camera/transform");
  fault("<scale>2.5</scale>", "<scale>-2</scale>", "transform/scale");
  fault("sensor_id=\"1\"", "sensor_id=\"44\"", "sensor 44");
  fault("label=\"b\"", "label=\"\"", "label is empty");
  fault("</chunk>", "", "not valid XML");
}

TEST_CASE("CSV and XMP files of RealityScan give exact cameras") {
  const Cameras cameras = with(exactCameras(), brownTerms);
  Files files(cameras);
  const std::string text = realityCsv(cameras);
  checkExact(files.read(text), cameras, false);
  CHECK(poseFormatOf(files.file) == PoseFormat::realityCsv);
  files.damage(text);
  CHECK_THAT(files.faultOf(replaced(text, ",0,", ",0.1,"), ErrorCode::unsupported),
             Contains("poses:3") && Contains("k4"));
  CHECK_THAT(files.faultOf(replaced(text, "sub/a.png,1", "sub/a.png,x")), Contains("poses:3: sub/a.png: x \"x\""));
  CHECK_THAT(files.faultOf(replaced(text, "sub/a.png,1", "sub/a.png")), Contains("15 columns"));
  CHECK_THAT(files.faultOf(replaced(text, ",28.125,", ",-1,")), Contains("sub/a.png"));
  CHECK_THAT(files.faultOf(replaced(text, "sub/a.png", "gone.png"), ErrorCode::io),
             Contains("1 of the 3 photographs are missing") && Contains(": gone.png"));
  CHECK_THAT(files.faultOf("#name,x,y,alt,heading,pitch,roll,f\n"), Contains("no camera"));

  const fs::path folder = files.folder / "xmp";
  for (const bool attributes : {false, true}) {
    for (const ExactCamera& c : cameras) {
      fs::create_directories((folder / c.name).parent_path());
      writeFile((folder / c.name).replace_extension(".xmp"), xmp(c, "brown3t2", attributes));
    }
    CHECK(poseFormatOf(folder) == PoseFormat::realityXmp);
    checkExact(readPoseFile(folder, files.photographs), cameras, false);
  }
  const std::string good = xmp(cameras[1], "brown3t2", true);
  const auto fault = [&](const std::string& from, const std::string& to, const std::string& field, ErrorCode code) {
    writeFile(folder / "b.xmp", replaced(good, from, to));
    try {
      readPoseFile(folder, files.photographs);
      FAIL_CHECK("nothing was thrown");
    } catch (const Error& e) {
      CHECK(e.code() == code);
      CHECK_THAT(e.what(), Contains("b.xmp:") && Contains(field));
    }
  };
  fault("brown3t2", "division", "model division", ErrorCode::unsupported);
  fault("brown3t2", "perspective", "model perspective", ErrorCode::unsupported);
  fault("brown3t2", "magic", "magic", ErrorCode::unsupported);
  fault(" 0 ", " 0.2 ", "k4", ErrorCode::unsupported);
  fault("Skew=\"0\"", "Skew=\"1\"", "xcr:Skew", ErrorCode::unsupported);
  fault("AspectRatio=\"1\"", "AspectRatio=\"1.1\"", "xcr:AspectRatio", ErrorCode::unsupported);
  fault("FocalLength35mm=\"", "FocalLength35mm=\"x", "xcr:FocalLength35mm", ErrorCode::invalidInput);
  fault("xcr:FocalLength35mm", "xcr:Other", "FocalLength35mm", ErrorCode::invalidInput);
  fault("<xcr:Rotation>", "<xcr:Rotation>9 ", "xcr:Rotation", ErrorCode::invalidInput);
  fault("<xcr:Position>", "<xcr:Position>nan ", "xcr:Position", ErrorCode::invalidInput);
  fault("</x:xmpmeta>", "", "not valid XML", ErrorCode::invalidInput);
}

TEST_CASE("RealityScan's division model is exact, in XMP files and as the only term of CSV files") {
  for (const double division : {0.12, -0.15}) {
    const Cameras cameras = with(exactCameras(), [&](ExactCamera& c) { c.division = division, c.cx += 7.25; });
    Files files(cameras);
    const std::string text = realityCsv(cameras);
    checkExact(files.read(text), cameras, false);
    CHECK_THAT(files.messages.at(0), Contains("3 cameras have only k1"));
    const std::string renamed =
        replaced(text, "heading,pitch,roll,f,px,py", "yaw,pitch,roll,f_35mm,px_norm,py_norm");  // RealityScan 2
    checkExact(files.read(renamed), cameras, false);
    CHECK(poseFormatOf(files.file) == PoseFormat::realityCsv);
    for (const ExactCamera& c : cameras) {
      fs::create_directories((files.folder / "xmp" / c.name).parent_path());
      writeFile((files.folder / "xmp" / c.name).replace_extension(".xmp"), xmp(c, "division", true));
    }
    checkExact(readPoseFile(files.folder / "xmp", files.photographs), cameras, false);
  }
  const Cameras plain = exactCameras();
  Files files(plain);
  for (const ExactCamera& c : plain) {
    fs::create_directories((files.folder / "xmp" / c.name).parent_path());
    writeFile((files.folder / "xmp" / c.name).replace_extension(".xmp"), xmp(c, "none", true));
  }
  checkExact(readPoseFile(files.folder / "xmp", files.photographs), plain, false);
}

TEST_CASE("a file of poses is recognised by its content, not by its name") {
  const Cameras cameras = exactCameras();
  Files files(cameras);
  for (const char* name : {"poses.xml", "poses.csv", "poses.json", "poses.nvm", "poses.jpg", "poses"}) {
    files.file = files.folder / name;
    checkExact(files.read(openSfm(cameras, "brown").dump()), cameras, false);
    checkExact(files.read(metashape(cameras, "frame")), cameras, false);
    checkExact(files.read(nvm(cameras, false)), cameras, true);
    checkExact(files.read("\xef\xbb\xbf" + openMvg(cameras, "pinhole").dump()), cameras, true);
  }
  for (const char* text : {"", "{}", "[]", "hello", "<html/>", "a,b,c\n1,2,3\n"}) {
    CHECK_THAT(files.faultOf(text), Contains("in no known format") && Contains("Metashape"));
    CHECK_FALSE(poseFormatOf(files.file));
  }
  CHECK_THAT(files.faultOf("{\"frames\": ["), Contains("not valid JSON"));
  CHECK_THROWS_WITH(readPoseFile(files.folder / "none"), Contains("none"));
  CHECK_THROWS_WITH(readPoseFile(files.photographs), Contains("photographs") && Contains("XMP"));
}

TEST_CASE("images match photographs by path, then file name, then stem, if these are unambiguous") {
  Cameras cameras = exactCameras();
  Files files(cameras);
  const auto namesOf = [&](std::vector<std::string> names) {
    Cameras named = cameras;
    for (std::size_t i = 0; i < names.size(); ++i) named[i].name = names[i];
    std::vector<std::string> read;
    for (const PosedImage& image : files.read(openSfm(named, "brown").dump()).images) read.push_back(image.name);
    return read;
  };
  using Names = std::vector<std::string>;
  const Names expected{"b.png", "c.png", "sub/a.png"};
  CHECK(namesOf({"/data/set/photographs/sub/a.png", "..\\b.png", "C:\\x\\c.png"}) == expected);
  CHECK(namesOf({"a.png", "photographs/b", "c.tif"}) == expected);
  CHECK(namesOf({"a", "b.exr", "other/c.png"}) == expected);
  CHECK(namesOf({"gone.png", "b.png", "/x/away.png"}) == Names{"away.png", "b.png", "gone.png"});
  CHECK(namesOf({"b.png", "x/b.png", "c.png"}) == Names{"b.png", "c.png", "x/b.png"});  // b.png is taken
  writeImage(files.photographs / "a.png", Image8(640, 480, 3, 90));
  CHECK(namesOf({"x/a.png", "b.png", "c.png"}) == Names{"a.png", "b.png", "c.png"});    // the end of the path
  CHECK(namesOf({"x/a.jpg", "b.png", "c.png"}) == Names{"b.png", "c.png", "x/a.jpg"});  // two of this stem
  fs::rename(files.photographs / "a.png", files.photographs / "sub2.png");
  fs::create_directories(files.photographs / "other");
  writeImage(files.photographs / "other/a.png", Image8(640, 480, 3, 90));
  CHECK(namesOf({"a.png", "b.png", "c.png"})[0] == "a.png");  // two photographs of this name
  CHECK_THROWS_WITH(namesOf({"x/c.png", "y/c.png", "b.png"}), Contains("both match the photograph c.png"));
}
