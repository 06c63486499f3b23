// SPDX-License-Identifier: Apache-2.0
#include "fuzz_target.h"
#include "ibr/texture.h"

using namespace ibr;
using namespace ibr::test;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const TemporaryFolder folder;
  put(folder / "a.ktx2", textOf(data, size));
  return answers([] {
    const Ktx2Info info = probeKtx2(folder / "a.ktx2");
    for (int first = 0; first < info.levels; ++first) {
      const Texture texture = readKtx2(folder / "a.ktx2", first);
      demand(int(texture.levels.size()) == info.levels - first);
    }
  });
}

std::vector<std::string> ibr::test::seeds() {
  const TemporaryFolder folder;
  std::vector<std::string> all;
  for (const TextureFormat format : {TextureFormat::rgba8, TextureFormat::bc1, TextureFormat::bc7}) {
    writeKtx2(folder / "a.ktx2", encodeTexture(buildMips(Image8(13, 6, 3, 77)), format));
    all.push_back(readTextFile(folder / "a.ktx2"));
  }
  Texture depth;
  depth.format = TextureFormat::rg16f;
  depth.width = 5;
  depth.height = 3;
  depth.levels.emplace_back(60, std::byte(0x3A));
  writeKtx2(folder / "a.ktx2", depth);
  all.push_back(readTextFile(folder / "a.ktx2"));
  return all;
}
