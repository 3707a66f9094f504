// The result of an emitter; main.cc writes it.
#pragma once

#include <string>
#include <vector>

namespace rubricc {

struct GeneratedFile {
  std::string path;  // From the project's folder, with '/': "codec/generated/rubicon/tables.h".
  std::string text;
};
using GeneratedFiles = std::vector<GeneratedFile>;

}  // namespace rubricc
