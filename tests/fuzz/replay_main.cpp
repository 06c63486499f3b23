// SPDX-License-Identifier: Apache-2.0
// Runs a fuzz target without a fuzzer: the seeds, the seeds cut at up to 200 positions, and the seeds with up to
// 400 deterministic changes of one to three bytes or bits. Also replays files of given folders (inputs that once
// failed). Finally checks that no input took more than 10 s and that memory stayed below IBR_FUZZ_MIB (default
// 600).
//
//   ibr_fuzz_NAME [FOLDER …]            replays
//   ibr_fuzz_NAME --write FOLDER        writes the seeds into FOLDER, for libFuzzer
//   IBR_FUZZ_ROUNDS=N                   makes N changes instead of 400
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <random>

#include "fuzz_target.h"

namespace fs = std::filesystem;
using namespace ibr::test;

namespace {

long inputs = 0;
double longest = 0;

void run(const std::string& input) {
  const auto start = std::chrono::steady_clock::now();
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(input.data()), input.size());
  longest = std::max(longest, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  ++inputs;
}

void change(std::string& input, std::mt19937& random) {
  static const char interesting[] = {0, 1, -1, 127, -128, '-', '9', 'e', '{', '"', ' ', '\n'};
  const std::size_t at = random() % input.size();
  switch (random() % 4) {
    case 0:
      input[at] = char(input[at] ^ char(1u << random() % 8));
      break;
    case 1:
      input[at] = interesting[random() % sizeof interesting];
      break;
    case 2:
      for (std::size_t k = at; k < std::min(input.size(), at + 4); ++k) input[k] = char(random() % 3 ? -1 : 127);
      break;
    default:
      input[at] = char(random());
  }
}

void spoil(const std::string& seed, int rounds) {
  run(seed);
  const std::size_t step = std::max<std::size_t>(1, seed.size() / 200);
  for (std::size_t length = 0; length < seed.size(); length += step) run(seed.substr(0, length));
  std::mt19937 random(1);
  for (int round = 0; round < rounds && !seed.empty(); ++round) {
    std::string input = seed;
    for (auto changes = 1 + random() % 3; changes > 0; --changes) change(input, random);
    run(input);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<std::string> good = seeds();
  if (argc == 3 && std::string_view(argv[1]) == "--write") {
    fs::create_directories(argv[2]);
    for (std::size_t i = 0; i < good.size(); ++i) put(fs::path(argv[2]) / ("seed" + std::to_string(i)), good[i]);
    return 0;
  }
  const char* wanted = std::getenv("IBR_FUZZ_ROUNDS");
  for (const std::string& seed : good) spoil(seed, wanted ? std::atoi(wanted) : 400);
  for (int i = 1; i < argc; ++i)
    if (fs::is_directory(argv[i]))
      for (const auto& entry : fs::directory_iterator(argv[i])) run(ibr::readTextFile(entry.path()));
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  const char* limit = std::getenv("IBR_FUZZ_MIB");
  const long mib = usage.ru_maxrss / 1024, most = limit ? std::atol(limit) : 600;
  std::printf("%ld inputs, the longest %.2f s, %ld MiB\n", inputs, longest, mib);
  return mib <= most && longest < 10 ? 0 : 1;
}
