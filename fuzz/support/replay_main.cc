// Runs a fuzz target without a fuzzing engine: on each file of the given folders, and on a fixed
// number of mutations of each, made by the target's own mutator if it has one. A broken property
// ends the process with a signal; the file is named before.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "fuzz/support/mutate_bytes.h"
#include "tools/tests/made_inputs.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
extern "C" __attribute__((weak)) int LLVMFuzzerInitialize(int* argc, char*** argv);
extern "C" __attribute__((weak)) std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data,
                                                                     std::size_t size,
                                                                     std::size_t max_size,
                                                                     unsigned seed);

namespace {

namespace fs = std::filesystem;

constexpr unsigned kMutations = rubric::made_inputs(20);
constexpr unsigned kPlainMutations = rubric::made_inputs(200);  // Less likely to reach far.
constexpr std::size_t kMaxSize = 4096;

std::vector<fs::path> files_in(const fs::path& path) {
  if (!fs::is_directory(path)) return {path};
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(path)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<std::uint8_t> bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error(path.string() + ": cannot be read");
  return {std::istreambuf_iterator<char>(file), {}};
}

unsigned long replay(const std::vector<std::uint8_t>& input) {
  LLVMFuzzerTestOneInput(input.data(), input.size());
  const bool aware = LLVMFuzzerCustomMutator != nullptr;
  const auto mutate = aware ? &LLVMFuzzerCustomMutator : &rubric::fuzz::mutate_bytes;
  const unsigned mutations = aware ? kMutations : kPlainMutations;
  for (unsigned seed = 1; seed <= mutations; ++seed) {
    std::vector<std::uint8_t> mutated = input;
    mutated.resize(std::max(kMaxSize, input.size()));
    mutated.resize(mutate(mutated.data(), input.size(), mutated.size(), seed));
    LLVMFuzzerTestOneInput(mutated.data(), mutated.size());
  }
  return 1 + mutations;
}

}  // namespace

int main(int argc, char** argv) try {
  if (LLVMFuzzerInitialize != nullptr) LLVMFuzzerInitialize(&argc, &argv);
  unsigned long files = 0;
  unsigned long runs = 0;
  for (int i = 1; i < argc; ++i) {
    for (const fs::path& file : files_in(argv[i])) {
      std::fprintf(stderr, "%s\n", file.c_str());
      runs += replay(bytes_of(file));
      ++files;
    }
  }
  std::printf("%lu files, %lu runs\n", files, runs);
  return files == 0 ? 1 : 0;  // A replay of nothing proves nothing.
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
