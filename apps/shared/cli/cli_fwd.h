// SPDX-License-Identifier: Apache-2.0
// Declares CLI11's types: its own header adds 5 to 7 seconds to the compilation of a source. Sources declare their
// options through options.h, which does not include it; only options.cpp, presets.cpp and the table of commands
// (batch/program.cpp) do.
#pragma once

namespace CLI {
class App;
class Option;
}  // namespace CLI
