// SPDX-License-Identifier: Apache-2.0
// Fuzz target for poses: each file of a COLMAP model as text and as binary, transforms.json, panoramas.json.
#include "fuzz_target.h"
#include "ibr/author/poses.h"

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

const char* const kTexts[] = {"cameras.txt", "images.txt", "points3D.txt"};
const char* const kBinaries[] = {"cameras.bin", "images.bin", "points3D.bin"};

struct Models {
  TemporaryFolder folder;
  std::string good[6];
  fs::path file(std::size_t i) const { return i < 3 ? folder / "text" / kTexts[i] : folder / "bin" / kBinaries[i - 3]; }
  Models() {
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
  const Chosen input = chosen(data, size, 8);
  if (input.file >= 6) {
    const fs::path file = models.folder / "poses.json";
    put(file, input.bytes);
    return answers([&] { input.file == 6 ? readTransforms(file) : readPanoramas(file); });
  }
  put(models.file(input.file), input.bytes);
  const int answer = answers([&] { readColmapModel(models.file(input.file).parent_path()); });
  put(models.file(input.file), models.good[input.file]);
  return answer;
}

std::vector<std::string> ibr::test::seeds() {
  const Models models;
  std::vector<std::string> all;
  for (std::size_t i = 0; i < 6; ++i) all.push_back(char(i) + models.good[i]);
  all.push_back(char(6) + std::string(kTransforms));
  all.push_back(char(7) + std::string(kPanoramas));
  return all;
}
