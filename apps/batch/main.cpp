// SPDX-License-Identifier: Apache-2.0
// The program `ibr` and its table of commands.
#include <array>

#include "batch/program.h"

int main(int argc, char** argv) {
  using namespace ibr::app;
  constexpr std::array kCommands{
      &kBuildCommand,    &kRenderCommand, &kViewCommand,    &kInfoCommand,     &kDoctorCommand,
      &kEvalCommand,     &kWalkCommand,   &kCompareCommand, &kValidateCommand, &kRefineCommand,
      &kOptimiseCommand, &kSplitCommand,  &kHtmCommand,     &kBenchCommand,    &kTradeoffCommand,
  };
  return runProgram({"ibr",
                     "Examples:\n"
                     "  ibr build photographs -o scene\n"
                     "  ibr view scene\n"
                     "  ibr render scene --path auto:90 -o pictures\n\n"
                     "ibr renders new views from photographs with known poses.\n",
                     kCommands},
                    argc, argv);
}
