#include <map>
#include <set>

#include "conformance/selftest/mutants/fields.h"
#include "conformance/selftest/mutants/hunt.h"
#include "conformance/test/runner/subject_target.h"
#include "conformance/trace/events/lines.h"
#include "conformance/trace/trace.h"

namespace rubric::mutants {
namespace {

constexpr Ticks kPeriodTicks = 1000;  // For the ack timeout; two of the join timer and the clock.

std::string text(ReqId requirement) { return std::string(trace::requirement_text(requirement)); }

StepMaker at_kind(const std::string& kind, void (*act)(Moment&, const Action&)) {
  return [=]() -> Step {
    return [=](Moment& moment) {
      moment.honest();
      const Actions honest = moment.actions;
      moment.rewrite([&](const Action& action) {
        if (kind_of(action, honest) != kind) return moment.keep(action);
        act(moment, action);
      });
    };
  };
}

const char* const kRoles[] = {"mote", "sink", "base_station"};

bool ignores_anything(const Actions& actions) {
  for (const Action& action : actions.all()) {
    if (action.what == Action::What::kIgnored) return true;
  }
  return false;
}

struct Ignored {
  Role role;
  ReqId requirement;
  friend auto operator<=>(const Ignored&, const Ignored&) = default;
};
using Ways = std::map<Ignored, std::set<std::size_t>>;  // Indices of mends().

// Returns the ways that make a difference, for every `ignored` of the golden traces.
Ways ways_to_accept(const Golden& golden) {
  Ways ways;
  watch(golden, [&](const State& before, Ticks now, const Event& event, const State&,
                    const Actions& actions) {
    for (const Action& action : actions.all()) {
      if (action.what != Action::What::kIgnored || action.requirement == ReqId::kNone) continue;
      std::set<std::size_t>& found = ways[{before.config.role, action.requirement}];
      for (std::size_t i = 0; i < mends().size(); ++i) {
        if (found.contains(i)) continue;
        Body body{.state = before};
        Actions mended;
        Moment moment(body, now, event, mended);
        if (mends()[i].step(moment) && !ignores_anything(mended)) found.insert(i);
      }
    }
  });
  return ways;
}

StepMaker accepting(ReqId requirement, std::size_t mend) {
  return [=]() -> Step {
    return [=](Moment& moment) {
      const State before = moment.state;
      moment.honest();
      if (!ignores(moment.actions, requirement)) return;
      const Actions honest = moment.actions;
      const State after = moment.state;
      moment.state = before;
      if (mends()[mend].step(moment)) return;
      moment.state = after;
      moment.actions = honest;
    };
  };
}

StepMaker only(Role role, StepMaker make) {
  return [=]() -> Step {
    return [role, step = make()](Moment& moment) {
      if (moment.is(role)) return step(moment);
      moment.honest();
    };
  };
}

}  // namespace

std::string kind_of(const Action& action, const Actions& actions) {
  if (action.what == Action::What::kTransmit) {
    return "send " + text(action.requirement) + " " + anatomy(actions.transmit_of(action)).name;
  }
  if (action.what == Action::What::kNotify) {
    return "tell " + text(action.requirement) + " " +
           events::from_notice(actions.notice_of(action)).name;
  }
  return "";
}

std::set<std::string> kinds_of(const Actions& actions) {
  std::set<std::string> kinds;
  for (const Action& action : actions.all()) {
    if (action.what == Action::What::kIgnored) kinds.insert("ignore " + text(action.requirement));
    kinds.insert(kind_of(action, actions));
  }
  kinds.erase("");
  return kinds;
}

Mutants action_mutants(const Golden& golden) {
  std::set<std::string> kinds;
  watch(golden, [&](const State&, Ticks, const Event&, const State&, const Actions& actions) {
    for (const Action& action : actions.all()) kinds.insert(kind_of(action, actions));
  });
  kinds.erase("");
  Mutants out;
  const auto act = [&](const std::string& name, const std::string& kind, const char* breaks,
                       void (*how)(Moment&, const Action&)) {
    out.push_back({name + ": " + kind, breaks, {}, at_kind(kind, how), kind});
  };
  for (const std::string& kind : kinds) {
    act("drop", kind, "It does not happen.", [](Moment&, const Action&) {});
    act("double", kind, "It happens twice.", [](Moment& moment, const Action& action) {
      moment.keep(action);
      moment.keep(action);
    });
    act("delay", kind, "It happens a period later.",
        [](Moment& moment, const Action& action) { moment.hold(action, kPeriodTicks); });
  }
  return out;
}

Mutants acceptance_mutants(const Golden& golden) {
  Mutants out;
  for (const auto& [ignored, found] : ways_to_accept(golden)) {
    for (const std::size_t i : found) {
      const std::string name = "accept: " + text(ignored.requirement) + " " +
                               kRoles[static_cast<int>(ignored.role)] + " " + mends()[i].name;
      out.push_back({name,
                     "What the rule ignores is accepted.",
                     {},
                     only(ignored.role, accepting(ignored.requirement, i)),
                     "ignore " + text(ignored.requirement)});
    }
  }
  return out;
}

std::vector<std::string> never_accepted(const Golden& golden) {
  std::vector<std::string> out;
  for (const auto& [ignored, found] : ways_to_accept(golden)) {
    if (!found.empty()) continue;
    out.push_back(text(ignored.requirement) + " " + kRoles[static_cast<int>(ignored.role)]);
  }
  return out;
}

Mutants generated_mutants(const Golden& golden) {
  Mutants out = action_mutants(golden);
  for (const Mutants& more : {field_mutants(golden), acceptance_mutants(golden)}) {
    out.insert(out.end(), more.begin(), more.end());
  }
  return out;
}

}  // namespace rubric::mutants
