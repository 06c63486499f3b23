// SPDX-License-Identifier: Apache-2.0
// Shaders that change while a program runs ([T] §4.1.3): for people who work on libibr, from its source tree.
//
//   ShaderReloader reloader(device, {.folder = "…/libibr/shaders"});
//   every frame:
//     const ShaderReloader::Result result = reloader.poll();     // show reloader.failing()
//     if (!result.replaced.empty()) try {
//       renderer = Renderer(device, gpuScene, options);          // once the device is done with the old one
//     } catch (const Error& error) {
//       reloader.takeBack();                                     // the old one goes on; show error
//     }
//
// Departure: [T]'s watchdog flags a program and the main thread compiles it. Here compiling is in the background too,
// by the compiler and with the flags of the build, and a shader is replaced only where it fits the pipelines that the
// program makes.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "ibr/device.h"
#include "ibr/log.h"

namespace ibr {

struct ShaderReloadOptions {
  std::filesystem::path folder;  // shaders/ of a source tree, near to the one that the program was built from
  std::string compiler = "glslangValidator";  // looked for along PATH unless it names a folder
  LogCallback log;                            // what is replaced (info) and what fails (warning)
};

/// Keeps the shaders of one device as they stand in a folder. Shaders are those that libibr embeds, by their path in
/// the folder ("render/composite.frag"); a file that is missing leaves what is in use. Files that were changed before
/// the reloader was made count as changed.
///
/// Move-only. Used by the thread that uses the device, which must outlive it; one at a time for a device. It has
/// threads of its own that touch no device and run the compiler, at most one a core. Without one, nothing costs
/// anything.
class ShaderReloader {
 public:
  struct Failure {
    std::string file;  // the shader, as in `replaced`
    std::string text;  // the compiler's, which names files and lines; or where the interface differs, a line each
  };
  struct Result {
    std::vector<std::string> replaced;
    std::vector<Failure> failed;  // that were not known with the same text
  };

  /// Starts compiling all shaders: to learn what they include, and what was changed before. Throws Error{io}
  /// that names the folder, where it is none, or the compiler, where it cannot be run.
  ShaderReloader(Device& device, ShaderReloadOptions options);
  ShaderReloader(ShaderReloader&&) noexcept;
  ShaderReloader& operator=(ShaderReloader&&) noexcept;
  ~ShaderReloader();  // ends a compiler that runs; what was replaced stays so

  /// What has become of the changes since the last call; waits for no compiler. Files are looked at ten times a second
  /// at most, and only while poll() is called. A shader is compiled when it or a file that it includes has another
  /// size or time; one that failed, when anything in the folder has. Its words are taken into use if they differ from
  /// those in use and fit the embedded shader: the same stage, workgroup, inputs, outputs and specialisation
  /// constants, no other bindings, no more push constants and no further features of the device. Otherwise it is
  /// `failed` and what is in use stays. Layouts are compared by size alone: an edit of a struct that C++ shares
  /// (shaders/shared) wants a build.
  ///
  /// Where something was replaced Device::shaderGeneration() has been raised. Pipelines that exist are never touched.
  Result poll();

  /// The shaders whose files, as they are, cannot be used: what poll() reported and was not mended since.
  std::vector<Failure> failing() const;

  /// Puts back what the last poll() that replaced something found in use, for when pipelines cannot be made from it;
  /// raises the generation, and returns the files: none where there is nothing to take back. They are compiled again
  /// when they are changed again.
  std::vector<std::string> takeBack();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace ibr
