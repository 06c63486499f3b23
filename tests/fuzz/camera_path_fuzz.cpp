// SPDX-License-Identifier: Apache-2.0
#include "fuzz_target.h"
#include "shared/camera/camera_path.h"

using namespace ibr;
using namespace ibr::test;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const TemporaryFolder folder;
  put(folder / "a.json", textOf(data, size));
  return answers([] {
    const app::CameraPath path = app::readCameraPath(folder / "a.json");
    const double end = path.keys.back().time;
    for (const double time : {-1.0, 0.0, 0.3 * end, end, 2 * end})
      demand(app::cameraAt(path, time).intrinsics.width == path.width);
  });
}

std::vector<std::string> ibr::test::seeds() {
  return {R"({"version":1,"size":[320,240],"fps":30,"keys":[
{"time":0,"position":[0,0,0],"rotation":[0,0,0,1],"fovY":1},
{"time":0.5,"position":[1,0.5,0],"rotation":[0,0.1,0,0.995],"fovY":1.1},
{"time":2,"position":[2,0,-1],"rotation":[0,0.70710678,0,0.70710678],"fovY":0.9}]})"};
}
