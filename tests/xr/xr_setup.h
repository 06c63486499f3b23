// SPDX-License-Identifier: Apache-2.0
// A headset for one test: the runtime's settings in a new folder and at a free port, so that tests can run in parallel,
// with requested faults and a record of the submitted frames.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/support/run_program.h"
#include "ibr/image.h"
#include "remote_headset.h"
#include "support/json.h"
#include "support/temporary_folder.h"

namespace ibr::test {

enum class XrCompositor { null, window };

class XrSetup {
 public:
  /// `faults`: as in faults.h. The null compositor needs no display; the other one opens a window.
  explicit XrSetup(std::string faults = "", XrCompositor compositor = XrCompositor::null);

  /// Environment with which a program finds this headset; entries NAME=value.
  std::vector<std::string> environment() const;

  /// Moves the headset and the hands, and waits until the program has submitted a few more frames. Returns false if the
  /// program ends first.
  bool move(RunningProgram& program, const RemoteState& state);
  /// Waits until the program has submitted the given number of frames.
  bool pass(RunningProgram& program, int frames);

  /// The images of both eyes in the next submitted frame, read back from the program's swapchains. readPictures() must
  /// be called before the program starts. Empty if the program ends first.
  std::vector<Image8> pictures(RunningProgram& program);
  void readPictures() { reads_ = true; }

  /// Uses the installed software device instead of the runtime's. Its multiview is broken on Debian 12, and only there.
  void useStockDevice() { stock_ = true; }

  /// Lines of the record (frame_record.h): all lines, or only those of frames.
  std::vector<nlohmann::json> record() const;
  std::vector<nlohmann::json> frames() const;
  /// The session's states in order, in one line.
  std::string states() const;

  const TemporaryFolder& folder() const { return folder_; }

 private:
  TemporaryFolder folder_;
  std::string faults_;
  XrCompositor compositor_;
  int port_;
  bool reads_ = false, stock_ = false;
  RemoteHeadset headset_;
};

}  // namespace ibr::test
