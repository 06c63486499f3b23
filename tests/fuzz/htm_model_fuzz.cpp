// SPDX-License-Identifier: Apache-2.0
// Fuzz target for model.gltf, its buffer, and the index of a sequence of models.
#include "fuzz_target.h"
#include "ibr/htm_sequence.h"
#include "robustness/example_model.h"

using namespace ibr;
using namespace ibr::test;

namespace {

constexpr const char* kSequence = R"({"version": 1, "fps": 25, "frames": ["a", "b"]})";

struct Place {
  TemporaryFolder folder;
  std::filesystem::path files[2];
  std::string good[2];
  Place() {
    writeExampleModel(folder.path());
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder.path())) {
      if (entry.path().extension() == ".gltf") files[0] = entry.path();
      if (entry.path().extension() == ".bin") files[1] = entry.path();
    }
    for (int i = 0; i < 2; ++i) good[i] = readTextFile(files[i]);
  }
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const Place place;
  static const TemporaryFolder index;
  const Chosen input = chosen(data, size, 3);
  if (input.file == 2) {
    put(index / kHtmSequenceFileName, input.bytes);
    return answers([] { loadHtmSequence(index.path()); });
  }
  put(place.files[input.file], input.bytes);
  const int answer = answers([&] { demand(validate(loadHtmModel(place.folder.path())).empty()); });
  put(place.files[input.file], place.good[input.file]);
  return answer;
}

std::vector<std::string> ibr::test::seeds() {
  const Place place;
  return {char(0) + place.good[0], char(1) + place.good[1], char(2) + std::string(kSequence)};
}
