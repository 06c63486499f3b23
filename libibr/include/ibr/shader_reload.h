// SPDX-License-Identifier: Apache-2.0
// Reloads shaders while a program runs ([T] §4.1.3), for developers of libibr with its source tree.
//
//   ShaderReloader reloader(device, {.folder = "…/shaders"});
//   every frame:
//     const ShaderReloader::Result result = reloader.poll();     // show reloader.failures()
//     if (!result.replaced.empty()) try {
//       renderer = Renderer(device, gpuScene, options);          // once the device has finished with the old one
//     } catch (const Error& error) {
//       reloader.revert();                                     // keep the old one; show error
//     }
//
// Deviation: [T]'s watchdog flags a program and the main thread compiles it. Here background threads compile, too, with
// the compiler and flags of the build. A shader is replaced only if it fits the pipelines that the program makes.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "ibr/device.h"
#include "ibr/export.h"
#include "ibr/log.h"

namespace ibr {

/// Options of a ShaderReloader.
struct ShaderReloadOptions {
  std::filesystem::path folder;  // shaders/ of a source tree that is close to the one the program was built from
  std::string compiler = "glslangValidator";  // program, searched along PATH unless it names a folder
  LogCallback log;                            // gets replaced shaders (info) and failed ones (warning)
};

/// Keeps a device's shaders in step with the files of a folder. Covers the shaders that libibr embeds, by their path in
/// the folder ("render/composite.frag"). A missing file leaves the shader in use. Files changed before the reloader was
/// made count as changed.
///
/// Move-only. Used by the thread that uses the device; the device must outlive it. One reloader at a time per device.
/// Its own threads run the compiler, at most one per core, and do not touch the device. Without a reloader there is no
/// cost.
class IBR_API ShaderReloader {
 public:
  /// A shader whose current file cannot be used.
  struct Failure {
    std::string file;  // the shader, as in Result::replaced
    std::string text;  // the compiler's output with files and lines, or the differences of the interface, one a line
  };
  /// Result of poll().
  struct Result {
    std::vector<std::string> replaced;  // shaders, as paths in the folder
    std::vector<Failure> failed;        // failures that were not reported before with the same text
  };

  /// Starts compiling all shaders, to learn their includes and to find files that were changed before. Throws Error{io}
  /// that names the folder if it is not one, or the compiler if it cannot be run.
  ShaderReloader(Device& device, ShaderReloadOptions options);
  ShaderReloader(ShaderReloader&&) noexcept;
  ShaderReloader& operator=(ShaderReloader&&) noexcept;
  ~ShaderReloader();  // stops a running compiler; replaced shaders stay replaced

  /// Takes results of compilations into use, and reports them; never waits for the compiler, but looks up files and
  /// allocates host memory. Files are checked at most ten times a second, and only while poll() is called. A shader is
  /// compiled if its file or an included file has another size or modification time; after a failure, if any file in
  /// the folder has. New code is used if it differs from the code in use and fits the embedded shader. It fits with the
  /// same stage, workgroup, inputs, outputs and specialisation constants, no other bindings, no more push constants and
  /// no further device features. Otherwise it is reported in `failed` and the code in use stays. Layouts are compared
  /// by size alone: editing a struct that is shared with C++ (shaders/shared) requires a build.
  ///
  /// A replacement increments Device::shaderGeneration(). Existing pipelines are never touched.
  Result poll();

  /// Returns the shaders whose current files cannot be used: failures that poll() reported and that have not been fixed
  /// since.
  std::vector<Failure> failures() const;

  /// Undoes the last poll() that replaced shaders, for when pipelines cannot be made from them. Increments
  /// Device::shaderGeneration() and returns the restored files; returns none if there is nothing to undo. The restored
  /// files are compiled again once they change again.
  std::vector<std::string> revert();

 private:
  struct IBR_LOCAL State;
  std::unique_ptr<State> state_;
};

}  // namespace ibr
