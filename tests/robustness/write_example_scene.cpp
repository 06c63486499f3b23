// SPDX-License-Identifier: Apache-2.0
// write_example_scene FOLDER: writes FOLDER/scene and FOLDER/model, for external validators (JSON Schema, glTF).
#include <exception>
#include <filesystem>
#include <iostream>

#include "example_model.h"
#include "example_scene.h"

int main(int count, char** arguments) try {
  if (count != 2) {
    std::cerr << "usage: write_example_scene FOLDER\n";
    return 1;
  }
  const std::filesystem::path folder = arguments[1];
  ibr::test::writeExampleScene(folder / "scene");
  ibr::test::writeExampleModel(folder / "model");
  return 0;
} catch (const std::exception& e) {
  std::cerr << e.what() << '\n';
  return 1;
}
