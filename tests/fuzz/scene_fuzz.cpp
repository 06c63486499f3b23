// SPDX-License-Identifier: Apache-2.0
// Fuzz target for scene.gltf and the buffer of its first cell.
#include "fuzz_target.h"
#include "ibr/scene.h"
#include "robustness/example_scene.h"

using namespace ibr;
using namespace ibr::test;

namespace {

struct Place {
  TemporaryFolder folder;
  std::filesystem::path files[2];
  std::string good[2];
  Place() {
    writeExampleScene(folder.path());
    files[0] = folder / "scene.gltf";
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path()))
      if (entry.path().extension() == ".bin" && (files[1].empty() || entry.path() < files[1])) files[1] = entry.path();
    for (int i = 0; i < 2; ++i) good[i] = readTextFile(files[i]);
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Place place;
  const Chosen input = chosen(data, size, 2);
  put(place.files[input.file], input.bytes);
  const int answer = answers([&] {
    const Scene scene = loadScene(place.folder.path());
    demand(validate(scene).empty());
  });
  put(place.files[input.file], place.good[input.file]);
  return answer;
}

std::vector<std::string> ibr::test::seeds() {
  const Place place;
  return {char(0) + place.good[0], char(1) + place.good[1]};
}
