// SPDX-License-Identifier: Apache-2.0
#include "ibr/scene.h"

#include "base/check.h"
#include "base/file.h"

namespace ibr {
namespace fs = std::filesystem;

namespace {

// Makes `to` a hard link to `from`, or a copy if the file system has none. Replaces an existing `to` atomically. Files
// here are replaced when they are written again (writeFile), so neither name sees a later change of the other.
void shareFile(const fs::path& from, const fs::path& to) {
  std::error_code error;
  check(fs::is_regular_file(from, error), ErrorCode::io, "{}: is not a file", from.string());
  makeFolders(to.parent_path());
  if (fs::equivalent(from, to, error)) return;
  fs::path draft = to;
  draft += ".link.tmp";
  fs::remove(draft, error);
  fs::create_hard_link(from, draft, error);
  if (error) return writeFile(to, readFile(from));
  fs::rename(draft, to, error);
  if (!error) return;
  std::error_code ignored;
  fs::remove(draft, ignored);
  fail(ErrorCode::io, "{}: {}", to.string(), error.message());
}

}  // namespace

void saveSceneWithLinks(const Scene& scene, const fs::path& folder) {
  for (const Node& node : scene.nodes)
    for (const fs::path& file : {node.imageFile, node.textureFile, node.maskFile, node.depthFile})
      if (!file.empty()) shareFile(pathInside(scene.folder, file), folder / file);
  saveScene(scene, folder);
}

}  // namespace ibr
