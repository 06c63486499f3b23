// SPDX-License-Identifier: Apache-2.0
// Reload of shaders edited while a program runs ([T] §4.1.3).
#include "ibr/shader_reload.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <chrono>
#include <thread>

#include "base/file.h"
#include "reference/stage.h"
#include "support/error_of.h"
#include "support/gpu.h"
#include "support/temporary_folder.h"

using namespace ibr;
using namespace ibr::test;
using Catch::Contains;
namespace fs = std::filesystem;
using Files = std::vector<std::string>;

namespace {

const std::string kComposite = "render/composite.frag";

/// A copy of some shaders that a test edits. Its path contains a space, to test the compiler's command line.
class Copy {
 public:
  explicit Copy(const Files& files = {kComposite, "render/composite.vert", "render/colour_apply.comp"}) {
    fs::create_directories(path / "render");
    fs::copy(fs::path(IBR_SHADER_FOLDER) / "shared", path / "shared");
    for (const std::string& file : files) fs::copy_file(fs::path(IBR_SHADER_FOLDER) / file, path / file);
  }
  std::string text(const std::string& file) const { return readTextFile(path / file); }
  void write(const std::string& file, const std::string& text) const { writeFile(path / file, std::string_view(text)); }
  void edit(const std::string& file, const std::string& from, const std::string& to) const {
    std::string all = text(file);
    const auto at = all.rfind(from);
    REQUIRE(at != all.npos);
    write(file, all.replace(at, from.size(), to));
  }
  ShaderReloadOptions options() const { return {.folder = path}; }

 private:
  TemporaryFolder folder_;

 public:
  const fs::path path = folder_ / "my shaders";
};

/// Waits for the next non-empty result. At first all shaders are compiled, which takes long on a busy machine.
ShaderReloader::Result next(ShaderReloader& reloader) {
  using namespace std::chrono_literals;
  for (int i = 0; i < 6000; ++i) {
    ShaderReloader::Result result = reloader.poll();
    if (!result.replaced.empty() || !result.failed.empty()) return result;
    std::this_thread::sleep_for(10ms);
  }
  FAIL("no shader was compiled within a minute");
  return {};
}

Files filesOf(const std::vector<ShaderReloader::Failure>& failures) {
  Files files;
  for (const auto& failure : failures) files.push_back(failure.file);
  return files;
}

SyntheticOptions small() {
  SyntheticOptions options = place(2);
  for (Camera& camera : options.cameras) camera = cameraAt(camera.pose.position, 0, 0, 64, 48);
  return options;
}

Image8 picture(const Stage& stage) {
  return stage.render(cameraAt({0.45, 0.3, 0.1}, 0.05, 0, 64, 48));
}

Image8 redAndBlueSwapped(Image8 image) {
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) std::swap(image.pixel(x, y)[0], image.pixel(x, y)[2]);
  return image;
}

const std::string kEnd = "keepTier != 0 ? shown.a : 1.0);\n";
const std::string kSwap = kEnd + "  outColour = outColour.bgra;\n";

}  // namespace

TEST_CASE("an edited shader changes images of new renderers on its device only") {
  const Copy copy;
  Device device = Device::create({.validation = true, .log = testLog()});
  const Stage stage(device, makeScene(small())), other(testDevice(), makeScene(small()));
  const Image8 before = picture(stage);
  const FramePlan plan = stage.plan(cameraAt({0.45, 0.3, 0.1}, 0.05, 0, 64, 48));
  const Renderer old(device, stage.gpuScene(), {.maxExtent = {64, 48}});
  Offscreen offscreen(device, {64, 48});
  const auto drawnByOld = [&] {
    return offscreen.render([&](VkCommandBuffer commands) { old.record(commands, plan, offscreen.target()); });
  };
  const Image8 oldBefore = drawnByOld();

  ShaderReloader reloader(device, copy.options());
  CHECK(device.shaderGeneration() == 0);
  copy.edit(kComposite, kEnd, kSwap);
  const ShaderReloader::Result result = next(reloader);
  CHECK(result.replaced == Files{kComposite});
  CHECK(result.failed.empty());
  CHECK(device.shaderGeneration() == 1);
  const Image8 after = picture(stage);
  CHECK(after.values != before.values);
  CHECK(after.values == redAndBlueSwapped(before).values);
  CHECK(drawnByOld().values == oldBefore.values);
  CHECK(picture(other).values == before.values);
  CHECK(testDevice().shaderGeneration() == 0);

  SECTION("a restored file restores the image") {
    copy.edit(kComposite, kSwap, kEnd);
    CHECK(next(reloader).replaced == Files{kComposite});
    CHECK(device.shaderGeneration() == 2);
    CHECK(picture(stage).values == before.values);
  }
  SECTION("a replacement is undone once") {
    CHECK(reloader.revert() == Files{kComposite});
    CHECK(device.shaderGeneration() == 2);
    CHECK(picture(stage).values == before.values);
    CHECK(reloader.revert().empty());
    CHECK(device.shaderGeneration() == 2);
  }
  SECTION("undoing the second replacement restores the first") {
    copy.edit(kComposite, ".bgra", ".gggg");
    CHECK(next(reloader).replaced == Files{kComposite});
    CHECK(picture(stage).values != after.values);
    CHECK(reloader.revert() == Files{kComposite});
    CHECK(picture(stage).values == after.values);
  }
  SECTION("a removed file changes nothing, and its replacement is used") {
    fs::remove(copy.path / kComposite);
    copy.edit("render/composite.vert", "gl_Position", "float unused = 1.0; gl_Position");
    CHECK(next(reloader).replaced == Files{"render/composite.vert"});
    CHECK(picture(stage).values == after.values);
    fs::copy_file(fs::path(IBR_SHADER_FOLDER) / kComposite, copy.path / kComposite);
    CHECK(next(reloader).replaced == Files{kComposite});
    CHECK(picture(stage).values == before.values);
  }
}

TEST_CASE("a broken file keeps the shader in use, and the compiler's text gives the line") {
  const Copy copy;
  Device device = Device::create({.validation = true, .log = testLog()});
  const Stage stage(device, makeScene(small()));
  const Image8 before = picture(stage);
  std::vector<std::string> log;
  ShaderReloadOptions options = copy.options();
  options.log = [&](LogLevel level, std::string_view message) {
    if (level == LogLevel::warning) log.emplace_back(message);
  };
  ShaderReloader reloader(device, options);
  const std::string whole = copy.text(kComposite);
  const auto failure = [&] {
    const ShaderReloader::Result result = next(reloader);
    CHECK(result.replaced.empty());
    REQUIRE(filesOf(result.failed) == Files{kComposite});
    CHECK(filesOf(reloader.failures()) == Files{kComposite});
    CHECK(device.shaderGeneration() == 0);
    return result.failed[0].text;
  };

  SECTION("a syntax error that is fixed") {
    copy.edit(kComposite, kEnd, kEnd + "  nonsense;\n");
    const std::string all = copy.text(kComposite);
    const auto line = 1 + std::count(all.begin(), all.begin() + long(all.find("nonsense")), '\n');
    CHECK_THAT(failure(), Contains("my shaders/render/composite.frag:" + std::to_string(line) + ": 'nonsense'"));
    CHECK(log.size() == 1);
    CHECK(picture(stage).values == before.values);
    copy.edit("render/composite.vert", "gl_Position", "float more = 1.0; gl_Position");  // recompiles the other, too
    const ShaderReloader::Result again = next(reloader);
    CHECK(again.replaced == Files{"render/composite.vert"});
    CHECK(again.failed.empty());
    CHECK(filesOf(reloader.failures()) == Files{kComposite});
    copy.write(kComposite, whole);  // the text in use: the only news is that the shader compiles
    copy.edit("render/composite.vert", "gl_Position", "float unused = 1.0; gl_Position");
    CHECK(next(reloader).replaced == Files{"render/composite.vert"});
    for (int i = 0; i < 1000 && !reloader.failures().empty(); ++i) {
      reloader.poll();
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    CHECK(reloader.failures().empty());
  }
  SECTION("an error in an included file that is fixed") {
    copy.write("shared/floor.h", copy.text("shared/floor.h") + "\nfloat broken = nothing;\n");
    CHECK_THAT(failure(), Contains("my shaders/shared/floor.h:") && Contains("'nothing'"));
    copy.edit("shared/floor.h", "nothing;", "1.0;\n#define texelFetch(image, at, level) vec4(1.0, 0.0, 0.0, 1.0)");
    CHECK(next(reloader).replaced == Files{kComposite});
    CHECK(reloader.failures().empty());
    const Image8 red = picture(stage);
    for (const auto& [x, y] : {std::pair(0, 0), std::pair(40, 30)})
      CHECK((red.pixel(x, y)[0] == 255 && red.pixel(x, y)[1] == 0 && red.pixel(x, y)[2] == 0));
  }
  SECTION("a new binding") {
    copy.edit(kComposite, "layout(location = 0)",
              "layout(set = 0, binding = 7) uniform sampler2D extra;\nlayout(location = 0)");
    copy.edit(kComposite, kEnd, kEnd + "  outColour += texelFetch(extra, ivec2(0), 0);\n");
    CHECK_THAT(failure(), Contains("binding 7") && Contains("extra"));
  }
  SECTION("larger push constants") {
    copy.edit(kComposite, "  FloorConstants plane;", "  FloorConstants plane;\n  vec4 more;");
    CHECK_THAT(failure(), Contains("push constants"));
  }
  SECTION("a missing output") {
    copy.edit(kComposite, "layout(location = 0) out vec4", "vec4");
    CHECK_THAT(failure(), Contains("location 0") && Contains("outColour"));
  }
  CHECK((device.shaderGeneration() > 0 || picture(stage).values == before.values));
}

TEST_CASE("files edited before the start are compiled, and unchanged files are not replaced") {
  const Copy copy;
  copy.edit("shared/floor.h", "#endif", "#define texelFetch(image, at, level) vec4(1.0)\n#endif");
  Device device = Device::create({.validation = true, .log = testLog()});
  ShaderReloader first(device, copy.options());
  CHECK(next(first).replaced == Files{kComposite});
  ShaderReloader moved = std::move(first);
  Device movedDevice = std::move(device);
  copy.write("shared/floor.h", readTextFile(fs::path(IBR_SHADER_FOLDER) / "shared/floor.h"));
  CHECK(next(moved).replaced == Files{kComposite});
  CHECK(movedDevice.shaderGeneration() == 2);
}

TEST_CASE("an unchanged folder replaces nothing") {
  const TemporaryFolder folder;
  fs::copy(IBR_SHADER_FOLDER, folder / "s", fs::copy_options::recursive);
  ShaderReloader reloader(testDevice(), {.folder = folder / "s"});
  std::string text = readTextFile(folder / "s/htm/htm_rank.comp");
  writeFile(folder / "s/htm/htm_rank.comp", std::string_view(text + "\nbroken\n"));
  const ShaderReloader::Result result = next(reloader);
  CHECK(result.replaced.empty());
  CHECK(filesOf(result.failed) == Files{"htm/htm_rank.comp"});
  CHECK(testDevice().shaderGeneration() == 0);
}

TEST_CASE("a missing compiler or folder and a failing compiler are named") {
  const Copy copy;
  ShaderReloadOptions options = copy.options();
  options.compiler = "no-such-compiler";
  const Error missing = errorOf([&] { ShaderReloader(testDevice(), options); });
  CHECK(missing.code() == ErrorCode::io);
  CHECK_THAT(missing.what(), Contains("no-such-compiler"));
  const Error folder = errorOf([] { ShaderReloader(testDevice(), {.folder = "/no/such/folder"}); });
  CHECK(folder.code() == ErrorCode::io);
  CHECK_THAT(folder.what(), Contains("/no/such/folder"));

  const auto failureOf = [&](const std::string& script) {
    options.compiler = copy.path / "compiler";
    writeFile(options.compiler, std::string_view("#!/bin/sh\n[ \"$1\" = --version ] && exit 0\n" + script));
    fs::permissions(options.compiler, fs::perms::owner_all);
    ShaderReloader reloader(testDevice(), options);
    const ShaderReloader::Result result = next(reloader);
    CHECK(result.replaced.empty());
    CHECK(result.failed.size() == 3);
    return result.failed.at(0).text;
  };
  CHECK_THAT(failureOf("exit 3\n"), Contains("compiler: ") && Contains("status 3"));
  CHECK_THAT(failureOf("exit 0\n"), Contains(".spv"));
  const std::string toOutput = "while [ \"$1\" != -o ]; do shift; done\n";
  CHECK_THAT(failureOf(toOutput + "printf 'abc' > \"$2\"\n"), Contains("3 bytes") && Contains("SPIR-V"));
  CHECK_THAT(failureOf(toOutput + "printf 'abcdabcdabcdabcdabcd' > \"$2\"; : > \"${2%.spv}.d\"\n"),
             Contains("SPIR-V") && Contains("header"));
  CHECK(testDevice().shaderGeneration() == 0);
}
