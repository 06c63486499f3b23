// SPDX-License-Identifier: Apache-2.0
// Interfaces read from SPIR-V, interface changes, and data that is not valid SPIR-V.
#include "gpu/draw/spirv_interface.h"

#include <catch2/catch.hpp>
#include <random>
#include <vector>

#include "base/file.h"
#include "reload/embedded_shaders.h"
#include "reload/shader_compile.h"
#include "support/error_of.h"
#include "support/temporary_folder.h"

using namespace ibr;
using namespace ibr::test;
using Catch::Contains;
using InterfaceSlot = SpirvInterface::InterfaceSlot;

namespace {

SpirvInterface of(const std::string& source, const std::string& stage) {
  const TemporaryFolder folder;
  writeFile(folder / ("a." + stage),
            std::string_view("#version 460\n#extension GL_EXT_scalar_block_layout : require\n" + source));
  const CompiledShader compiled =
      compileShader("glslangValidator", folder.path(), "a." + stage, folder / "out", [] { return true; });
  INFO(compiled.text);
  REQUIRE(!compiled.words.empty());
  return spirvInterface(compiled.words);
}

std::span<const std::uint32_t> embedded(std::string_view file) {
  for (const EmbeddedShader& shader : embeddedShaders())
    if (shader.file == file) return *shader.words;
  FAIL("no such shader");
  return {};
}

const std::string kFragment = R"(
layout(constant_id = 3) const bool kSwitch = false;
layout(set = 0, binding = 0) uniform sampler2D picture;
layout(set = 1, binding = 2, scalar) readonly buffer Items { vec3 item[]; };
layout(push_constant, scalar) uniform Constants { mat3 turn; vec2 by; float each[3]; };
layout(location = 0) in vec2 at;
layout(location = 1) flat in uint which;
layout(location = 0) out vec4 colour;
void main() {
  colour = texture(picture, at + by * each[1]) + vec4(turn * item[which], kSwitch ? 1.0 : 0.0);
}
)";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  REQUIRE(at != text.npos);
  return text.replace(at, from.size(), to);
}

}  // namespace

TEST_CASE("the interface of a fragment shader matches its source") {
  const SpirvInterface read = of(kFragment, "frag");
  CHECK(read.stage == 4);
  CHECK(read.entryPoint == "main");
  CHECK(read.pushConstantBytes == 36 + 8 + 12);
  REQUIRE(read.bindings.size() == 2);
  CHECK(read.bindings.at({0, 0}).name == "picture");
  CHECK_THAT(read.bindings.at({0, 0}).type, Contains("sampled image"));
  CHECK_THAT(read.bindings.at({1, 2}).type, Contains("storage read-only") && Contains("12"));
  REQUIRE(read.inputs.size() == 2);
  CHECK(read.inputs.at({0, 0}).type == "float32x2");
  CHECK(read.inputs.at({1, 0}).type == "flat uint32");
  REQUIRE(read.outputs.size() == 1);
  CHECK(read.outputs.at({0, 0}).name == "colour");
  REQUIRE(read.constants.size() == 1);
  CHECK(read.constants.at({3, 0}).type == "bool");
  CHECK(interfaceMismatch(read, read).empty());
}

TEST_CASE("a changed interface is reported with the names of the changes") {
  const SpirvInterface own = of(kFragment, "frag");
  struct Case {
    std::string from, to;
    std::vector<std::string> says;
  };
  const Case cases[]{
      {"layout(location = 0) in",
       "layout(set = 0, binding = 7) uniform sampler2D extra;\nlayout(location = 0) in",
       {"set 0", "binding 7", "extra"}},
      {"set = 0, binding = 0", "set = 2, binding = 0", {"set 2", "binding 0", "picture"}},
      {"uniform sampler2D picture",
       "uniform sampler2DShadow shadow;\nvec4 texture(float a, vec2 b) { return vec4(a); }\n"
       "const float picture = 1.0",
       {"set 0", "binding 0", "shadow"}},
      {"vec3 item[]",
       "vec3 item[]; }; layout(set = 1, binding = 3) buffer More { uint more[]",
       {"set 1", "binding 3", "More"}},
      {"{ vec3 item[]", "{ vec3 item[4]; vec3 rest[]", {"binding 2", "Items", "48"}},
      {"readonly buffer", "buffer", {"binding 2", "Items", "read-only"}},
      {"float each[3]", "float each[4]", {"push constants", "60", "56"}},
      {"in vec2 at", "in vec3 at3; const vec2 at = vec2(0.5)", {"input", "location 0", "at3", "float32x3"}},
      {"flat in uint", "flat in int", {"input", "location 1", "which", "flat int32", "flat uint32"}},
      {"layout(location = 0) out vec4", "vec4", {"output", "location 0", "colour", "float32x4"}},
      {"layout(location = 0) out", "layout(location = 1) out", {"output", "location 1", "colour"}},
      {"constant_id = 3", "constant_id = 4", {"constant 3", "kSwitch"}},
      {"void main() {", "void main() { double d = at.x; if (d > 2.0LF) discard;", {"capability 10"}}};
  for (const Case& c : cases) {
    const SpirvInterface other = of(replaced(kFragment, c.from, c.to), "frag");
    INFO(c.to);
    for (const std::string& token : c.says) CHECK_THAT(interfaceMismatch(own, other), Contains(token));
  }
  CHECK_THAT(interfaceMismatch(of("layout(local_size_x = 64) in; void main() {}", "comp"),
                               of("layout(local_size_x = 8, local_size_y = 8) in; void main() {}", "comp")),
             Contains("workgroup") && Contains("8x8x1") && Contains("64x1x1"));
  CHECK_THAT(interfaceMismatch(own, of("void main() {}", "vert")), Contains("stage") && Contains("0") && Contains("4"));
}

TEST_CASE("unused inputs and internal changes do not change the interface") {
  const SpirvInterface own = of(kFragment, "frag");
  const std::pair<std::string, std::string> harmless[]{
      {"texture(picture, at + by * each[1])", "vec4(textureQueryLod(picture, at), at)"},
      {"layout(set = 0, binding = 0) uniform sampler2D picture;",
       "vec4 texture(int p, vec2 at) { return vec4(0); }"
       "const int picture = 0;"},
      {"; float each[3]", ""},
      {"in vec2 at;", "in vec2 at; const float kMore = 2.0;"}};
  for (const auto& [from, to] : harmless) {
    std::string source = replaced(kFragment, from, to);
    if (to.empty()) source = replaced(source, " * each[1]", "");
    INFO(to);
    CHECK(interfaceMismatch(own, of(source, "frag")).empty());
  }
}

TEST_CASE("all embedded shaders can be read and match themselves") {
  CHECK(embeddedShaders().size() >= 30);
  for (const EmbeddedShader& shader : embeddedShaders()) {
    INFO(shader.file);
    const SpirvInterface read = spirvInterface(*shader.words);
    CHECK(read.entryPoint == "main");
    CHECK(interfaceMismatch(read, read).empty());
    const bool compute = shader.file.ends_with(".comp");
    CHECK(read.stage == (compute ? 5u : shader.file.ends_with(".frag") ? 4u : 0u));
    CHECK((read.workgroup[0] > 0) == compute);
  }
}

TEST_CASE("words that are not SPIR-V throw an error") {
  const auto thrown = [](std::vector<std::uint32_t> words) { return errorOf([&] { spirvInterface(words); }); };
  CHECK(thrown({}).code() == ErrorCode::invalidInput);
  CHECK_THAT(thrown({1, 2, 3, 4, 5, 6}).what(), Contains("header"));
  const std::span<const std::uint32_t> words = embedded("render/composite.frag");
  const std::vector<std::uint32_t> header(words.begin(), words.begin() + 5);
  const auto after = [&](std::initializer_list<std::uint32_t> more) {
    std::vector<std::uint32_t> all = header;
    all.insert(all.end(), more);
    return std::string(thrown(all).what());
  };
  CHECK_THAT(after({}), Contains("0 entry points"));
  CHECK_THAT(after({0}), Contains("word 5") && Contains("0 words"));
  CHECK_THAT(after({0xffff0011}), Contains("word 5") && Contains("65535 words"));
  CHECK_THAT(after({0x00010011}), Contains("word 5") && Contains("17"));  // OpCapability without operand
  CHECK_THAT(after({0x00030005, 1, 0x41414141}), Contains("word 5") && Contains("string"));  // OpName
  CHECK_THAT(after({0x00040017, 1, 1, 4}), Contains("type 1"));                              // a vector of itself
  CHECK_THAT(after({0x0003001e, 7, 7}), Contains("type 7"));                                 // a structure of itself
  CHECK_THAT(after({0x0004003b, 9, 2, 0}), Contains("pointer 9"));                           // a variable

  // Each structure contains the previous one twice: 2⁴⁰ leaves.
  std::vector<std::uint32_t> deep = header;
  deep.insert(deep.end(), {0x00030016, 1, 32});
  for (std::uint32_t i = 2; i < 42; ++i) deep.insert(deep.end(), {0x0004001e, i, i - 1, i - 1});
  CHECK_THAT(thrown(deep).what(), Contains("0 entry points"));

  std::size_t refused = 0;
  const auto survives = [&](std::span<const std::uint32_t> spoilt) {
    try {
      spirvInterface(spoilt);
    } catch (const Error& error) {
      ++refused;
      if (error.code() != ErrorCode::invalidInput) FAIL(error.what());
    }
  };
  for (std::size_t n = 0; n < words.size(); n += 3) survives(std::vector(words.begin(), words.begin() + long(n)));
  std::mt19937 random(1);
  for (std::size_t i = 0; i < words.size(); ++i) {
    std::vector<std::uint32_t> spoilt(words.begin(), words.end());
    spoilt[i] = std::vector<std::uint32_t>{0, 0xffffffff, std::uint32_t(random()), spoilt[i] + 1}[i % 4];
    survives(spoilt);
  }
  CHECK(refused > words.size() / 4);
}

TEST_CASE("prerequisites of a rule are read, with spaces in their names") {
  CHECK(prerequisites("out.spv: /a\\ b/c.frag /a\\ b/x/../d.h \\\n /e\n") ==
        std::vector<std::filesystem::path>{"/a b/c.frag", "/a b/d.h", "/e"});
  CHECK(prerequisites("").empty());
  CHECK(prerequisites("no rule").empty());
  CHECK(prerequisites("out: \\") == std::vector<std::filesystem::path>{"\\"});
}
