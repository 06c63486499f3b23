// SPDX-License-Identifier: Apache-2.0
// Fuzz target for poses: each file of a COLMAP model as text and as binary, and a file of any other format.
#include "fuzz_target.h"
#include "ibr/author/poses.h"
#include "io/image_file.h"

using namespace ibr;
using namespace ibr::test;
namespace fs = std::filesystem;

namespace {

constexpr const char* kTransforms =
    R"({"camera_model": "OPENCV", "w": 640, "h": 480, "fl_x": 500, "cx": 321, "cy": 239.5, "k1": 0.01, "p2": -1e-3,
"frames": [{"file_path": "a.png", "transform_matrix": [[1,0,0,1],[0,1,0,2],[0,0,1,3],[0,0,0,1]]},
{"file_path": "b.png", "k1": 0, "transform_matrix": [[0,0,1,1],[0,1,0,2],[-1,0,0,3],[0,0,0,1]]}]})";
constexpr const char* kPanoramas =
    R"({"width": 64, "height": 32, "panoramas": [
{"name": "a.jpg", "position": [1, 2, 3], "R_world_to_camera": [[1,0,0],[0,1,0],[0,0,1]]},
{"name": "b.jpg", "position": [2, 2, 3], "q_world_to_camera_wxyz": [1, 0, 0, 0], "t_world_to_camera": [-2, -2, -3]},
{"name": "c.jpg", "position": [2, 2, 4], "q_world_to_camera_wxyz": [0, 0, 0, 1]}], "triangles": [[0, 1, 2]]})";

constexpr const char* kBundler =
    "# Bundle file v0.3\n2 1\n80 0.1 -0.02\n1 0 0\n0 1 0\n0 0 1\n1 2 3\n0 0 0\n0 0 0\n0 0 0\n0 0 0\n0 0 0\n"
    "1 2 -9\n255 0 0\n2 0 0 1.5 -2 1 0 1 1\n";
constexpr const char* kNvm =
    "NVM_V3 FixedK 80 32 80 16 0\n\n2\na.png 80 1 0 0 0 1 2 3 0 0\nb.png 80 0.6 0 0.8 0 1 2 3 0 0\n\n1\n"
    "1 2 9 255 0 0 2 0 0 1.5 -2 1 0 1 1\n0\n";
constexpr const char* kOpenMvg =
    R"({"sfm_data_version": "0.3", "views": [{"key": 0, "value": {"polymorphic_id": 1073741824, "ptr_wrapper": {"id":
2147483649, "data": {"local_path": "", "filename": "a.png", "id_intrinsic": 0, "id_pose": 0}}}}], "intrinsics": [{"key": 0,
"value": {"polymorphic_id": 2147483649, "polymorphic_name": "pinhole_brown_t2", "ptr_wrapper": {"id": 2147483650, "data":
{"value0": {"width": 64, "height": 32, "focal_length": 80, "principal_point": [32, 16]}, "disto_t2": [0.1, 0, 0, 0.01,
0]}}}}], "extrinsics": [{"key": 0, "value": {"rotation": [[1,0,0],[0,1,0],[0,0,1]], "center": [1, 2, 3]}}], "structure":
[{"key": 0, "value": {"X": [1, 2, 9], "observations": [{"key": 0, "value": {"id_feat": 0, "x": [30, 12]}}]}}]})";
constexpr const char* kOpenSfm =
    R"([{"cameras": {"c": {"projection_type": "fisheye624", "width": 64, "height": 32, "focal_x": 0.8, "focal_y": 0.8,
"c_x": 0, "c_y": 0, "k1": 0.1, "k5": 0, "s0": 0.01}}, "shots": {"a.png": {"rotation": [0.1, 0.2, 0.3], "translation":
[1, 2, 3], "camera": "c"}}, "points": {"7": {"coordinates": [1, 2, 9]}}}])";
constexpr const char* kMetashape =
    R"(<document version="1.5.0"><chunk><sensors><sensor id="0" type="frame"><resolution width="64" height="32"/>
<calibration type="frame" class="adjusted"><resolution width="64" height="32"/><f>80</f><cx>1</cx><b1>0.5</b1><k1>0.1</k1>
<p1>0.01</p1></calibration></sensor></sensors><components><component id="0"><transform><rotation>1 0 0 0 1 0 0 0 1</rotation>
<translation>1 2 3</translation><scale>2</scale></transform></component></components><cameras><camera id="0" sensor_id="0"
component_id="0" label="a"><transform>1 0 0 1 0 1 0 2 0 0 1 3 0 0 0 1</transform></camera><group><camera id="1" sensor_id="0"
label="b"/></group></cameras></chunk></document>)";
constexpr const char* kRealityCsv =
    "#cameras "
    "1\n#name,x,y,alt,heading,pitch,roll,f,px,py,k1,k2,k3,k4,t1,t2\na.png,1,2,3,10,20,30,35,0.01,0,0.1,0,0,0,0.01,"
    "0\n";
constexpr const char* kXmp =
    R"(<x:xmpmeta xmlns:x="adobe:ns:meta/"><rdf:RDF xmlns:rdf="http://www.w3.org/1999/02/22-rdf-syntax-ns#"><rdf:Description
xcr:DistortionModel="brown3t2" xcr:FocalLength35mm="35" xcr:Skew="0" xcr:AspectRatio="1" xcr:PrincipalPointU="0.01"
xcr:DistortionCoeficients="0.1 0 0 0 0.01 0" xmlns:xcr="http://www.capturingreality.com/ns/xcr/1.1#"><xcr:Rotation>1 0 0 0 1
0 0 0 1</xcr:Rotation><xcr:Position>1 2 3</xcr:Position></rdf:Description></rdf:RDF></x:xmpmeta>)";
const char* const kOthers[] = {kTransforms, kPanoramas, kBundler,    kNvm, kOpenMvg,
                               kOpenSfm,    kMetashape, kRealityCsv, kXmp};
constexpr std::size_t kXmpFile = 6 + std::size(kOthers) - 1;

const char* const kTexts[] = {"cameras.txt", "images.txt", "points3D.txt"};
const char* const kBinaries[] = {"cameras.bin", "images.bin", "points3D.bin"};

struct Models {
  TemporaryFolder folder;
  std::string good[6];
  fs::path file(std::size_t i) const { return i < 3 ? folder / "text" / kTexts[i] : folder / "bin" / kBinaries[i - 3]; }
  Models() {
    for (const char* name : {"a.png", "b.png"}) {
      fs::create_directories(folder / "photographs");
      writeImage(folder / "photographs" / name, Image8(64, 32, 3));
    }
    fs::create_directories(folder / "xmp");
    put(folder / "list.txt", std::string("a.png\nb.png\n"));
    put(folder / "tracks.csv", std::string("a.png\t7\t0\t0.1\t0.1\t1\n"));
    fs::create_directories(folder / "text");
    fs::create_directories(folder / "bin");
    for (std::size_t i = 0; i < 6; ++i) {
      good[i] = readTextFile(fs::path(IBR_COLMAP_DATA) / (i < 3 ? "tiny" : "tiny_binary") / file(i).filename());
      put(file(i), good[i]);
    }
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Models models;
  const Chosen input = chosen(data, size, 6 + std::size(kOthers));
  if (input.file >= 6) {
    const bool isXmp = input.file == kXmpFile;
    const fs::path file = isXmp ? models.folder / "xmp/a.xmp" : models.folder / "poses";
    put(file, input.bytes);
    return answers([&] { readPoseFile(isXmp ? file.parent_path() : file, models.folder / "photographs"); });
  }
  put(models.file(input.file), input.bytes);
  const int answer = answers([&] { readPoseFile(models.file(input.file).parent_path()); });
  put(models.file(input.file), models.good[input.file]);
  return answer;
}

std::vector<std::string> ibr::test::seeds() {
  const Models models;
  std::vector<std::string> all;
  for (std::size_t i = 0; i < 6; ++i) all.push_back(char(i) + models.good[i]);
  for (std::size_t i = 0; i < std::size(kOthers); ++i) all.push_back(char(6 + i) + std::string(kOthers[i]));
  return all;
}
