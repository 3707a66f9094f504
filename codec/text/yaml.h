// Reads YAML texts that must be one document.
#pragma once

#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <optional>
#include <sstream>
#include <string>

namespace rubric::text {

/// A text goes on behind its first document: with another, or with something that fits nothing,
/// such as a comma before all else, which the parser takes for an empty document.
struct BehindDocument : YAML::ParserException {
  explicit BehindDocument(const YAML::Mark& at)
      : ParserException(at, "what is here belongs to nothing; one document was expected") {}
};

/// Returns the only document of a text, or a null. Throws YAML::Exception with its place, and
/// BehindDocument. (YAML::Load passes over what is behind the first document, and of such a comma
/// YAML::LoadAll makes documents without end.)
inline YAML::Node only_yaml_document(const std::string& text) {
  struct Starts : YAML::EventHandler {
    void OnDocumentStart(const YAML::Mark& mark) override { last = mark; }
    void OnDocumentEnd() override {}
    void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
    void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
    void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t,
                  const std::string&) override {}
    void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                         YAML::EmitterStyle::value) override {}
    void OnSequenceEnd() override {}
    void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                    YAML::EmitterStyle::value) override {}
    void OnMapEnd() override {}
    YAML::Mark last;
  } starts;
  std::istringstream in(text);
  YAML::Parser parser(in);
  if (parser.HandleNextDocument(starts) && parser.HandleNextDocument(starts)) {
    throw BehindDocument(starts.last);
  }
  return YAML::Load(text);
}

}  // namespace rubric::text
