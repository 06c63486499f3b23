// SPDX-License-Identifier: Apache-2.0
// write_example_scene FOLDER: for the validators that are not ours (JSON Schema, glTF).
#include <exception>
#include <iostream>

#include "example_scene.h"

int main(int count, char** arguments) try {
  if (count != 2) {
    std::cerr << "usage: write_example_scene FOLDER\n";
    return 1;
  }
  ibr::test::writeExampleScene(arguments[1]);
  return 0;
} catch (const std::exception& e) {
  std::cerr << e.what() << '\n';
  return 1;
}
