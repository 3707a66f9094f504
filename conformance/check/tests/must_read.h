// Reads runs that must be readable, for tests.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "conformance/check/input/read.h"

namespace rubric::check {

inline Run must_read(const std::vector<std::string>& files) {
  std::string error;
  std::optional<Run> run = read(files, error);
  EXPECT_TRUE(run) << error;
  return run ? std::move(*run) : Run{};
}

/// Reads the bytes of one file.
inline Run must_read(const std::string& name, std::string_view bytes) {
  RunReader reader;
  std::string error;
  EXPECT_TRUE(reader.add_bytes(name, bytes, error)) << error;
  return reader.finish();
}

}  // namespace rubric::check
