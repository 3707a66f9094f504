// The message in a frame is decided twice: by the tables and by the generated views (those of the
// carriers, payload_kind(), body_kind()). Over all captured frames and many made ones both must
// choose the same messages, refuse the same frames, and read the same values.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "codec/containers/tests/testing.h"
#include "codec/frame_generator/frame_generator.h"
#include "codec/frame_generator/values.h"
#include "codec/generated/rubicon/messages.h"
#include "codec/reflect/compare_view.h"
#include "codec/runtime/hdlc.h"
#include "tools/tests/made_inputs.h"
#include "tools/tests/readme/number.h"

namespace rubric::reflect {
namespace {

using namespace rubicon;

/// Returns the spec's name of a view's structure.
template <class View>
const std::string& id_of() {
  static const std::string id = [] {
    std::string found;
    const auto visit = [&found]<class T>(const char* name, ViewTag<T>) {
      if (std::is_same_v<T, View>) found = name;
    };
    rubicon::for_each_view(visit);
    return found;
  }();
  return id;
}

/// Follows the views' own choices from a carrier in, and compares each view with the nodes.
class Follower {
 public:
  explicit Follower(const Decoded& decoded) : decoded_(decoded), comparer_(decoded) {}

  template <class View>
  void message(const View& view, std::size_t node) {
    if (!path_.empty() && node == 0) return differ("only the view reads a " + id_of<View>());
    if (id_of<View>() != decoded_[node].type->id) {
      return differ("the view reads a " + id_of<View>() + ", the tables a " +
                    decoded_[node].type->id);
    }
    path_.push_back(id_of<View>());
    inside(view, comparer_.structure(view, node));
  }

  const std::vector<std::string>& path() const { return path_; }
  const ViewComparer& comparer() const { return comparer_; }

 private:
  void differ(const std::string& how) { comparer_.differ("dispatch", how); }
  template <class View>
  void inside(const View& view, std::size_t chosen) {
    bool reads_it = false;
    auto part = [&](Bytes, const auto& inner) {
      reads_it = true;
      message(inner, chosen);
    };
    visit_parts(view, part);
    if (!reads_it && chosen) {
      differ(std::string("only the tables read a ") + decoded_[chosen].type->id);
    }
  }

  const Decoded& decoded_;
  ViewComparer comparer_;
  std::vector<std::string> path_;
};

struct Tally {
  long frames = 0;
  long refused = 0;
  long numbers = 0;
  long elements = 0;
  std::map<std::string, long> chosen;  // By the views, as the whole path.
};

/// Returns where the two differ over a frame of the carrier; empty if they agree.
template <class View>
std::string difference(const char* carrier, Bytes frame, Tally& tally) {
  static thread_local Decoded decoded;
  const Type* type = find_carrier(tables::kProtocol, carrier);
  decode(*type, frame, Tail::kFault, false, decoded);
  ++tally.frames;
  const Result<View> view = View::parse(frame);
  // Bytes after the frame are for the view's caller to judge; the view only shows them.
  const bool trailing = decoded.error.fault == Fault::kTrailing;
  const Error wanted = trailing ? Error{Fault::kNone, 0, ReqId::kNone} : decoded.error;
  if (!(view.error() == wanted)) return "other errors";
  if (!view) {
    ++tally.refused;
    return "";
  }
  const std::size_t behind = trailing ? static_cast<std::size_t>(decoded.error_value) : 0;
  if (view->stale().size() != behind) return "other bytes after the frame";
  Follower follower(decoded);
  follower.message(*view, 0);
  if (!follower.comparer().difference().empty()) return follower.comparer().difference();
  std::vector<std::string> path{type->id};
  for (std::size_t i = 0; i < decoded.path_count(); ++i) path.push_back(decoded.path()[i]->id);
  const std::string chosen = fmt::format("{}", fmt::join(path, "/"));
  if (follower.path() != path) {
    return fmt::format("{}, not {}", fmt::join(follower.path(), "/"), chosen);
  }
  tally.numbers += follower.comparer().numbers();
  tally.elements += follower.comparer().elements();
  ++tally.chosen[chosen];
  return "";
}

/// Runs both readers on a frame; radio frames as I-frame and as T-frame, whatever they are.
void compare(Framing framing, Bytes frame, Tally& tally) {
  const std::string found = framing == Framing::kRadio
                                ? difference<RadioIFrameView>("radio_i", frame, tally) +
                                      difference<RadioTFrameView>("radio_t", frame, tally)
                                : difference<RubiconView>("serial", frame, tally);
  if (found.empty()) return;
  ADD_FAILURE() << found << "\n" << rubric::testing::to_hex(frame);
}

void print(const char* what, const Tally& tally) {
  std::printf("%s: %ld readings, %ld refused by both, %ld numbers and %ld elements compared\n",
              what, tally.frames, tally.refused, tally.numbers, tally.elements);
  for (const auto& [path, count] : tally.chosen) std::printf("%8ld %s\n", count, path.c_str());
}

/// Counts how often the views chose this path, or one that extends it.
long reached(const Tally& tally, const std::string& path) {
  long sum = 0;
  for (const auto& [longer, count] : tally.chosen) {
    if (longer == path || longer.starts_with(path + "/")) sum += count;
  }
  return sum;
}

/// Adds every path that the tables can choose below `type`.
void add_paths(const Type& type, const std::string& path, std::set<std::string>& out) {
  const auto add = [&](const Field& field) {
    const auto step = [&](const Type* inner) {
      if (!inner) return;
      const std::string longer = path + "/" + inner->id;
      out.insert(longer);
      add_paths(*inner, longer, out);
    };
    if (!field.choice) return step(field.type);
    for (int i = 0; i < field.choice->count; ++i) step(field.choice->cases[i].type);
    step(field.choice->otherwise);
  };
  for (int i = 0; i < type.field_count; ++i) {
    if (type.fields[i].choice) add(type.fields[i]);
  }
  for (int i = 0; i < type.interpretation_count; ++i) add(type.interpretations[i].field);
}

TEST(Dispatch, ViewsChooseWhatTheTablesChoose_Captures) {
  Tally tally;
  for (const auto& entry : std::filesystem::recursive_directory_iterator("spec/captures")) {
    static const std::set<std::string> kCaptures{".bin", ".pcapng", ".sfstream"};
    if (!kCaptures.contains(entry.path().extension())) continue;
    const std::string input = rubric::testing::read_file(entry.path());
    const auto reader = make_reader(detect(rubric::testing::view(input)));
    ASSERT_NE(reader, nullptr) << entry.path();
    for (const auto& kept : rubric::testing::read_all(*reader, rubric::testing::view(input))) {
      const Packet packet = kept.get();
      if (packet.framing == Framing::kHdlc && packet.kind == kSerialAck) continue;
      if (!packet.bytes.empty()) compare(packet.framing, packet.bytes, tally);
    }
  }
  print("captures", tally);
  EXPECT_GE(tally.frames, 900) << "run from the project's folder";
}

/// Changes a frame in one of the ways in which parsers go wrong.
void damage(generate::Generated& frame, generate::Random& random) {
  std::vector<std::uint8_t>& bytes = frame.bytes;
  switch (random.below(5)) {
    case 0: return bytes.resize(random.below(bytes.size() + 1));
    case 1: return bytes.resize(bytes.size() + 1 + random.below(5), generate::any_byte(random));
    case 2:
      if (bytes.empty()) return;
      bytes[random.below(bytes.size())] ^= static_cast<std::uint8_t>(1u << random.below(8));
      return;
    default: generate::change_field(tables::kProtocol, frame.framing, bytes, 250, random);
  }
}

TEST(Dispatch, ViewsChooseWhatTheTablesChoose_MadeFrames) {
  Tally tally;
  const int made = made_inputs(static_cast<int>(readme_number("# made-up frames")));
  generate::FrameGenerator generator(tables::kProtocol, messages::kRoutes, 20);
  generate::Random& random = generator.random();
  for (int i = 0; i < made && !::testing::Test::HasFailure(); ++i) {
    const Route& route = messages::kRoutes.routes[i % messages::kRoutes.count];
    generate::Generated frame =
        random.chance(0.2) ? generator.near_valid(route) : generator.valid(route);
    for (std::size_t n = random.below(3); n > 0; --n) damage(frame, random);
    compare(frame.framing, Bytes(frame.bytes.data(), frame.bytes.size()), tally);
  }
  print("made", tally);
  std::set<std::string> paths;
  for (const char* carrier : {"serial", "radio_i", "radio_t"}) {
    const Type* type = find_carrier(tables::kProtocol, carrier);
    add_paths(*type, type->id, paths);
  }
  std::printf("%zu paths that the tables have\n", paths.size());
  EXPECT_EQ(paths.size(), readme_number("# ways to a message"));
  const int least = made_inputs(static_cast<int>(readme_number("taken at least # times")));
  for (const std::string& path : paths) EXPECT_GE(reached(tally, path), least) << path;
  EXPECT_EQ(std::lround(static_cast<double>(tally.numbers) / made_inputs(1'000'000)),
            static_cast<long>(readme_number("# million numbers")));
  EXPECT_GE(tally.refused, made / 10);
}

}  // namespace
}  // namespace rubric::reflect
