#include "tools/commands/protocol_folder.h"

#include <fmt/format.h>

#include <filesystem>
#include <stdexcept>

#include "codec/reflect/suggest.h"
#include "conformance/trace/protocol.h"
#include "tools/cli/exit_codes.h"
#include "tools/cli/specs.h"
#include "tools/cli/verdict.h"

namespace rubric::tools {

namespace fs = std::filesystem;

void add_protocol_option(cli::Command& command, std::string& folder) {
  command.add_option("--protocol", folder,
                     "Work with the protocol of this folder in place of RUBICON: its app.yaml, "
                     "requirements.yaml and cases");
}

void use_protocol(const std::string& folder, const std::vector<std::string>& profiles,
                  std::vector<std::string>& traces) {
  if (folder.empty()) return;
  const std::string app = (fs::path(folder) / "app.yaml").string();
  const std::string text = cli::text_of_file(app);
  cli::use_requirements_of((fs::path(folder) / "requirements.yaml").string());
  // A name is a shipped spec, name.ksy a file of the folder.
  const auto find_wire = [&](const std::string& name) -> const reflect::Protocol& {
    const std::vector<std::string> shipped = cli::protocol_names();
    if (trace::is_among(shipped, name)) return cli::protocol_of(name);
    const std::string file = (fs::path(folder) / name).string();
    if (!name.ends_with(".ksy")) {
      throw std::invalid_argument(fmt::format(
          "expected a .ksy file of the folder, or a shipped spec (rubric decode --spec list), "
          "given '{}'{}",
          name, reflect::did_you_mean(name, shipped)));
    }
    if (!fs::exists(file)) throw std::invalid_argument("no file " + file);
    return cli::protocol_of(file);
  };
  try {
    trace::use(trace::read_protocol(text, app, find_wire));
  } catch (const cli::Ending&) {  // A mistake in the wire spec, which was printed.
    throw;
  } catch (const std::runtime_error& mistake) {
    cli::unreadable(mistake.what());
  }
  for (const std::string& profile : profiles) {
    if (profile.empty() || trace::is_among(trace::protocol().profiles, profile)) continue;
    throw cli::UsageError("--profile",
                          fmt::format("{} has no profile {}", trace::protocol().name, profile));
  }
  if (traces.empty()) traces.push_back((fs::path(folder) / "cases").string());
}

}  // namespace rubric::tools
