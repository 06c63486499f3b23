// SPDX-License-Identifier: Apache-2.0
// Declares CLI11's types: its own header adds two seconds to the compilation of a source.
#pragma once

namespace CLI {
class App;
class Option;
}  // namespace CLI
