// Writes the scripts of all golden traces into a folder, a file each: the seeds of the stateful
// fuzz targets.
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>

#include "conformance/selftest/scripts/bytes.h"
#include "conformance/selftest/scripts/rtr.h"

namespace {

int write_seeds(const std::filesystem::path& cases, const std::filesystem::path& folder) {
  using namespace rubric;
  std::filesystem::create_directories(folder);
  int written = 0;
  for (const script::CaseScript& each : script::golden_scripts(cases)) {
    const std::vector<std::uint8_t> bytes = script::encode(each.script);
    const std::filesystem::path path = folder / (each.name() + ".script");
    std::ofstream out(path, std::ios::binary);
    out.write(reinterpret_cast<const char*>(bytes.data()),
              static_cast<std::streamsize>(bytes.size()));
    if (!out.flush()) {
      std::fprintf(stderr, "%s: cannot be written\n", path.c_str());
      return 1;
    }
    ++written;
  }
  std::printf("%d scripts\n", written);
  return written == 0 ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 3) {
    std::fputs("Usage: rubric_script_seeds CASES FOLDER\n", stderr);
    return 2;
  }
  return write_seeds(argv[1], argv[2]);
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
