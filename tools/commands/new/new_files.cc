#include "tools/commands/new/new_files.h"

#include <list>
#include <system_error>

#include "codec/text/files.h"
#include "codec/text/text.h"
#include "tools/cli/exit_codes.h"
#include "tools/cli/output.h"

namespace rubric::tools {

namespace fs = std::filesystem;

void write_new_files(const std::string& command, const fs::path& folder,
                     const std::vector<std::pair<fs::path, std::string>>& files) {
  const auto refuse = [&](const fs::path& path, const std::string& why) {
    text::print(stderr, "rubric {}: cannot write {}: {}\n", command, path.string(), why);
    cli::exit_with(cli::kExitOutput);
  };
  std::error_code error;
  for (const auto& [name, content] : files) {
    const fs::path path = folder / name;
    fs::create_directories(path.parent_path(), error);
    if (error) refuse(path.parent_path(), error.message());
    if (fs::exists(fs::symlink_status(path, error))) {
      refuse(path, "it exists, and may hold your work");
    }
  }
  std::list<text::OutFile> written;  // Which are gone again if a later one cannot be written.
  const auto check = [](const fs::path& path, int code) {
    if (!cli::is_written(path.string(), code)) cli::exit_with(cli::kExitOutput);
  };
  for (const auto& [name, content] : files) {
    const fs::path path = folder / name;
    try {
      written.emplace_back(path.string(), text::OutFile::Mode::kWhole);
    } catch (const std::system_error& why) {
      cli::exit_with(cli::cannot_write(why));
    }
    check(path, text::write_all(written.back().fd(), content));
  }
  auto file = written.begin();
  for (const auto& [name, content] : files) {
    const fs::path path = folder / name;
    check(path, (file++)->finish());
    text::print(stdout, "wrote {}\n", path.lexically_normal().string());
  }
}

}  // namespace rubric::tools
