// SPDX-License-Identifier: Apache-2.0
// A headset of its own for a test: the runtime's settings in a fresh folder and at a free port, so that tests can run
// side by side, with faults to be made and a record of what the program submits.
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "apps/support/run_program.h"
#include "ibr/image.h"
#include "remote_headset.h"
#include "support/temporary_folder.h"

namespace ibr::test {

enum class XrCompositor { null, window };

class XrSetup {
 public:
  /// `faults` as in faults.h. The compositor that shows nothing needs no display; the other opens a window.
  explicit XrSetup(std::string faults = "", XrCompositor compositor = XrCompositor::null);

  /// What a program needs to come upon this headset; NAME=value.
  std::vector<std::string> environment() const;

  /// Moves the headset and the hands, and waits until the program has submitted a few frames after that; true when it
  /// has.
  bool move(RunningProgram& program, const RemoteState& state);
  /// Lets the program submit so many frames more.
  bool pass(RunningProgram& program, int frames);

  /// What the program submits next, by eye; read back from its swapchains, which readPictures() must have prepared
  /// before the program was started. Nothing where it ends before.
  std::vector<Image8> pictures(RunningProgram& program);
  void readPictures() { reads_ = true; }

  /// Debian 12's own software device, whose multiview is broken, instead of the one that is laid beside it.
  void useStockDevice() { stock_ = true; }

  /// Lines of the record (frame_record.h): all, or those of frames.
  std::vector<nlohmann::json> record() const;
  std::vector<nlohmann::json> frames() const;
  /// The states that the session went through, in one line.
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
