// rubric new-adapter: writes a working adapter of rct/1, to be filled with an implementation.
#pragma once

#include <string_view>
#include <vector>

namespace rubric::tools {

struct SkeletonFile {
  std::string_view language;
  std::string_view name;
  std::string_view text;
};
/// Returns the files of tools/skeletons, which the program contains.
const std::vector<SkeletonFile>& skeleton_files();

}  // namespace rubric::tools
