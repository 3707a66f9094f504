// The message in a frame is decided twice: by the tables and by the generated views (those of the
// carriers, payload_kind(), body_kind()). Over all captured frames and many made ones both must
// choose the same messages, refuse the same frames, and read the same values.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "codec/generated/rubicon/tables.h"
#include "codec/reflect/compare_view.h"
#include "codec/reflect/test_frames.h"
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
  void opaque(std::size_t chosen) {
    if (chosen) differ(std::string("only the tables read a ") + decoded_[chosen].type->id);
  }

  // Handles messages that hold no others.
  template <class View>
  void inside(const View&, std::size_t chosen) {
    opaque(chosen);
  }
  void inside(const RubiconView& view, std::size_t chosen) {
    using Kind = RubiconView::PayloadKind;
    switch (view.payload_kind()) {
      case Kind::kOpaque: return opaque(chosen);
      case Kind::kCommand: return message(view.payload_as_command(), chosen);
      case Kind::kSerialData: return message(view.payload_as_serial_data(), chosen);
      case Kind::kLearningModuleCmd: return message(view.payload_as_learning_module_cmd(), chosen);
      case Kind::kLearningModuleFloatCmd:
        return message(view.payload_as_learning_module_float_cmd(), chosen);
      case Kind::kNetMsg: return message(view.payload_as_net_msg(), chosen);
      case Kind::kConfig: return message(view.payload_as_config(), chosen);
    }
    differ("unknown kind of payload");
  }
  void inside(const RadioIFrameView& view, std::size_t chosen) { inside_radio(view, chosen); }
  void inside(const RadioTFrameView& view, std::size_t chosen) { inside_radio(view, chosen); }
  template <class View>
  void inside_radio(const View& view, std::size_t chosen) {
    using Kind = typename View::PayloadKind;
    switch (view.payload_kind()) {
      case Kind::kOpaque: return opaque(chosen);
      case Kind::kRssiBeacon: return message(view.payload_as_rssi_beacon(), chosen);
      case Kind::kJoinRequest: return message(view.payload_as_join_request(), chosen);
      case Kind::kJoinReply: return message(view.payload_as_join_reply(), chosen);
      case Kind::kNetMsg: return message(view.payload_as_net_msg(), chosen);
      case Kind::kAckJoin: return message(view.payload_as_ack_join(), chosen);
    }
    differ("unknown kind of payload");
  }
  void inside(const NetMsgView& view, std::size_t chosen) {
    using Kind = NetMsgView::PayloadKind;
    switch (view.payload_kind()) {
      case Kind::kOpaque: return opaque(chosen);
      case Kind::kAppMsgFromPc: return message(view.payload_as_app_msg_from_pc(), chosen);
      case Kind::kAppMsg: return message(view.payload_as_app_msg(), chosen);
    }
    differ("unknown kind of payload");
  }
  void inside(const AppMsgView& view, std::size_t chosen) {
    using Kind = AppMsgView::BodyKind;
    switch (view.body_kind()) {
      case Kind::kOpaque: return opaque(chosen);
      case Kind::kSerialJoined: return message(view.body_as_serial_joined(), chosen);
      case Kind::kUpdates: return message(view.body_as_updates(), chosen);
      case Kind::kReadUpdates: return message(view.body_as_read_updates(), chosen);
      case Kind::kDemo: return message(view.body_as_demo(), chosen);
      case Kind::kDemoData: return message(view.body_as_demo_data(), chosen);
      case Kind::kLearningNotification:
        return message(view.body_as_learning_notification(), chosen);
      case Kind::kLearningModuleDown: return message(view.body_as_learning_module_down(), chosen);
      case Kind::kLearningOutput: return message(view.body_as_learning_output(), chosen);
      case Kind::kRubiconAck: return message(view.body_as_rubicon_ack(), chosen);
      case Kind::kRubiconAckSeqOnly: return message(view.body_as_rubicon_ack_seq_only(), chosen);
      case Kind::kSynapticData: return message(view.body_as_synaptic_data(), chosen);
    }
    differ("unknown kind of body");
  }
  void inside(const AppMsgFromPcView& view, std::size_t chosen) {
    using Kind = AppMsgFromPcView::BodyKind;
    switch (view.body_kind()) {
      case Kind::kOpaque: return opaque(chosen);
      case Kind::kSerialJoined: return message(view.body_as_serial_joined(), chosen);
      case Kind::kUpdates: return message(view.body_as_updates(), chosen);
      case Kind::kReadUpdates: return message(view.body_as_read_updates(), chosen);
      case Kind::kDemo: return message(view.body_as_demo(), chosen);
      case Kind::kDemoData: return message(view.body_as_demo_data(), chosen);
      case Kind::kBroadcastCmd: return message(view.body_as_broadcast_cmd(), chosen);
      case Kind::kSynCreateCmd: return message(view.body_as_syn_create_cmd(), chosen);
      case Kind::kLearningModuleCmd: return message(view.body_as_learning_module_cmd(), chosen);
      case Kind::kLearningModuleFloatCmd:
        return message(view.body_as_learning_module_float_cmd(), chosen);
      case Kind::kNetidCmd: return message(view.body_as_netid_cmd(), chosen);
      case Kind::kRubiconAck: return message(view.body_as_rubicon_ack(), chosen);
      case Kind::kRubiconAckSeqOnly: return message(view.body_as_rubicon_ack_seq_only(), chosen);
      case Kind::kSynapticData: return message(view.body_as_synaptic_data(), chosen);
    }
    differ("unknown kind of body");
  }

  const Decoded& decoded_;
  ViewComparer comparer_;
  std::vector<std::string> path_;
};

std::string joined(const std::vector<std::string>& path) {
  std::string out;
  for (const std::string& id : path) out += (out.empty() ? "" : "/") + id;
  return out;
}

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
  if (follower.path() != path) return joined(follower.path()) + ", not " + joined(path);
  tally.numbers += follower.comparer().numbers();
  tally.elements += follower.comparer().elements();
  ++tally.chosen[joined(path)];
  return "";
}

/// Runs both readers on a frame; radio frames as I-frame and as T-frame, whatever they are.
void hold(const TestFrame& frame, Tally& tally) {
  const Bytes bytes(frame.bytes.data(), frame.bytes.size());
  const std::string found = frame.radio ? difference<RadioIFrameView>("radio_i", bytes, tally) +
                                              difference<RadioTFrameView>("radio_t", bytes, tally)
                                        : difference<RubiconView>("serial", bytes, tally);
  if (found.empty()) return;
  ADD_FAILURE() << found << "\n" << hex(frame.bytes);
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
  const std::vector<TestFrame> frames = captured_frames("spec/captures");
  for (const TestFrame& frame : frames) hold(frame, tally);
  print("captures", tally);
  EXPECT_GE(frames.size(), 900U) << "run from the project's folder";
}

TEST(Dispatch, ViewsChooseWhatTheTablesChoose_MadeFrames) {
  Tally tally;
  const int made = made_inputs(static_cast<int>(readme_number("# made-up frames")));
  FrameMaker maker(captured_frames("spec/captures"), tables::kProtocol, 20);
  for (int i = 0; i < made && !::testing::Test::HasFailure(); ++i) {
    hold(maker.make(), tally);
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
