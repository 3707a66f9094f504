// Results as the XML that collectors of JUnit read.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace rubric::report {

/// A testcase. Its names are unique in the document as far as the writer's caller makes them so.
struct JunitCase {
  enum class Outcome { kPassed, kFailure, kError, kSkipped };

  std::string class_name{};
  std::string name{};
  std::string file{};  ///< Empty: none is named.
  std::string seconds = "0";
  Outcome outcome = Outcome::kPassed;
  std::string type{};     ///< The type of a failure or an error.
  std::string message{};  ///< One line for all but a pass.
  std::string body{};     ///< The whole text of a failure or an error.
  std::string output{};   ///< Further text; empty: none.
};

struct JunitSuite {
  std::string name{};
  std::string seconds = "0";
  std::vector<std::pair<std::string, std::string>> properties{};
  std::vector<JunitCase> cases{};
  std::string output{};
};

/// Milliseconds as JUnit has times: "0.012".
std::string junit_seconds(double ms);

/// A document of all suites, each with its sums; with a name also the sums of the whole, which took
/// `seconds`.
std::string junit_document(const std::vector<JunitSuite>& suites, const std::string& name = "",
                           const std::string& seconds = "0");

}  // namespace rubric::report
