// SPDX-License-Identifier: Apache-2.0
#include "xr_setup.h"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "base/file.h"
#include "support/json.h"

namespace ibr::test {

using nlohmann::json;

namespace {

int freePort() {
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  REQUIRE(::bind(socket, reinterpret_cast<const sockaddr*>(&address), size) == 0);
  REQUIRE(::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size) == 0);
  ::close(socket);
  return ntohs(address.sin_port);
}

// Reads an image that SubmittedPictures wrote, as RGB.
Image8 readPicture(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  int width = 0, height = 0, format = 0;
  in >> width >> height >> format;
  in.ignore();
  constexpr int kBgraUnorm = 44, kBgraSrgb = 50;
  const bool swapped = format == kBgraUnorm || format == kBgraSrgb;
  Image8 image(width, height, 3);
  std::array<char, 4> pixel;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      in.read(pixel.data(), 4);
      for (std::size_t c = 0; c < 3; ++c) image.pixel(x, y)[c] = std::uint8_t(pixel[swapped ? 2 - c : c]);
    }
  REQUIRE(in.good());
  return image;
}

std::string runtimeFolder() {
  const char* folder = std::getenv("IBR_XR_RUNTIME");
  REQUIRE(folder);  // main.cpp ensures this
  return folder;
}

// Mesa's description of the installed software device; its name depends on Mesa's version.
std::filesystem::path installedDevice() {
  for (const auto& entry : std::filesystem::directory_iterator("/usr/share/vulkan/icd.d"))
    if (entry.path().filename().string().starts_with("lvp_icd")) return entry.path();
  FAIL("no software device is installed (Debian: mesa-vulkan-drivers)");
  return {};
}

}  // namespace

XrSetup::XrSetup(std::string faults, XrCompositor compositor)
    : faults_(std::move(faults)), compositor_(compositor), port_(freePort()), headset_(port_) {
  std::filesystem::create_directory(folder_ / "monado");
  const json settings{{"active", "remote"}, {"remote", {{"version", 0}, {"port", port_}, {"view_count", 2}}}};
  writeFile(folder_ / "monado/config_v0.json", jsonLine(settings));
}

std::vector<std::string> XrSetup::environment() const {
  std::vector<std::string> variables;
  std::ifstream in(runtimeFolder() + "/environment");
  for (std::string line; std::getline(in, line);) variables.push_back(line);
  REQUIRE(!variables.empty());
  if (stock_)
    for (const char* name : {"VK_DRIVER_FILES", "VK_ICD_FILENAMES"})
      variables.push_back(std::string(name) + '=' + installedDevice().string());
  if (stock_) variables.push_back("LD_LIBRARY_PATH=");
  variables.push_back("IBR_XR_RUNTIME_BEHIND=" + runtimeFolder() + "/libopenxr_monado.so");
  variables.push_back("XR_RUNTIME_JSON=" IBR_XR_FAULTS_MANIFEST);
  variables.push_back("IBR_XR_FAULTS=" + faults_);
  variables.push_back("IBR_XR_RECORD=" + (folder_ / "record").string());
  if (reads_) variables.push_back("IBR_XR_PICTURES=" + folder_.path().string());
  variables.push_back("XDG_CONFIG_HOME=" + folder_.path().string());
  variables.push_back("XDG_CACHE_HOME=" + folder_.path().string());
  for (const char* log : {"XRT_LOG", "XRT_COMPOSITOR_LOG", "PROBER_LOG", "REMOTE_LOG"})
    variables.push_back(std::string(log) + "=error");
  variables.push_back(compositor_ == XrCompositor::null ? "XRT_COMPOSITOR_NULL=1" : "XRT_COMPOSITOR_FORCE_XCB=1");
  return variables;
}

bool XrSetup::pass(RunningProgram& program, int count) {
  const std::size_t enough = frames().size() + std::size_t(count);
  return program.runsUntil([&] { return frames().size() >= enough; });
}

bool XrSetup::move(RunningProgram& program, const RemoteState& state) {
  // The first of the next frames may have located its views before.
  return program.runsUntil([&] { return headset_.send(state); }) && pass(program, 4);
}

std::vector<Image8> XrSetup::pictures(RunningProgram& program) {
  writeFile(folder_ / "wanted", std::string());
  if (!program.runsUntil([&] { return !std::filesystem::exists(folder_ / "wanted"); })) return {};
  return {readPicture(folder_ / "eye0"), readPicture(folder_ / "eye1")};
}

std::vector<json> XrSetup::record() const {
  std::vector<json> lines;
  std::ifstream in(folder_ / "record");
  for (std::string line; std::getline(in, line);)
    if (!in.eof()) lines.push_back(parseJson(line));  // the last line may be incomplete
  return lines;
}

std::vector<json> XrSetup::frames() const {
  std::vector<json> lines = record();
  std::erase_if(lines, [](const json& line) { return !line.contains("frame"); });
  return lines;
}

std::string XrSetup::states() const {
  std::string all;
  for (const json& line : record())
    if (line.contains("state")) all += (all.empty() ? "" : " ") + line["state"].get<std::string>();
  return all;
}

}  // namespace ibr::test
