// SPDX-License-Identifier: Apache-2.0
// The program `ibr-lab`: synthetic scenes with exact truth, and measurements of methods. Not installed.
#include <array>

#include "batch/program.h"
#include "lab/lab_commands.h"

int main(int argc, char** argv) {
  using namespace ibr::app;
  constexpr std::array kCommands{&kSynthCommand,    &kAccuracyCommand, &kSweepCommand,
                                 &kMatchersCommand, &kLabBenchCommand, &kLabStreamCommand};
  return runProgram({"ibr-lab",
                     "Examples:\n"
                     "  ibr-lab synth court -o court\n"
                     "  ibr-lab accuracy scene --truth held-out\n\n"
                     "ibr-lab generates scenes with exact ground truth and measures the methods of libibr.\n",
                     kCommands},
                    argc, argv);
}
