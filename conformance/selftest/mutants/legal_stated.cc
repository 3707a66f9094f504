// Legal variants with parameters of their own, which they state.
#include <random>

#include "conformance/selftest/mutants/fields.h"
#include "conformance/selftest/mutants/legal.h"

namespace rubric::mutants {
namespace {

using trace::ParameterId;

// The machine keeps what its configuration states.
void as_stated(Moment& moment) { moment.honest(); }

// Holds back what follows from the frames that `waits` chooses.
template <class Waits>
StepMaker late(Ticks ticks, Waits waits) {
  return [=]() -> Step {
    return [=](Moment& moment) {
      moment.honest();
      if (moment.heard() == nullptr || !waits(*moment.heard())) return;
      moment.rewrite([&](const Action& action) {
        const bool visible =
            action.what == Action::What::kTransmit || action.what == Action::What::kNotify;
        return visible ? moment.hold(action, ticks) : moment.keep(action);
      });
    };
  };
}

StepMaker late(Ticks ticks) {
  return late(ticks, [](const Frame&) { return true; });
}

// Two wrappers, the frames of the first held back by the second.
StepMaker late_and_backing_off(Ticks ticks, Ticks most) {
  return [=]() -> Step {
    std::minstd_rand random(static_cast<std::uint32_t>(ticks));
    return [=](Moment& moment) mutable {
      moment.honest();
      const Ticks wait = moment.heard() == nullptr ? 0 : ticks;
      moment.rewrite([&](const Action& action) {
        if (action.what == Action::What::kNotify && wait > 0) return moment.hold(action, wait);
        if (action.what != Action::What::kTransmit) return moment.keep(action);
        const bool radio = moment.sent(action).link == Link::kRadio;
        moment.hold(action, wait + (radio ? static_cast<Ticks>(random() % (most + 1)) : 0));
      });
    };
  };
}

}  // namespace

StepMaker backing_off(std::uint32_t seed, Ticks most) {
  return [=]() -> Step {
    std::minstd_rand random(seed + 1);
    return [=](Moment& moment) mutable {
      moment.honest();
      moment.rewrite([&](const Action& action) {
        const bool radio =
            action.what == Action::What::kTransmit && moment.sent(action).link == Link::kRadio;
        const Ticks wait = radio ? static_cast<Ticks>(random() % (most + 1)) : 0;
        return wait > 0 ? moment.hold(action, wait) : moment.keep(action);
      });
    };
  };
}

std::vector<LegalVariant> stated_variants() {
  const auto is_reply = [](const Frame& frame) { return frame.type == am::kJoinReply; };
  std::vector<LegalVariant> out;
  out.push_back({"ack_timeout_2000",
                 "The ack timeout takes 2000 ticks (110).",
                 always(as_stated),
                 false,
                 {{ParameterId::kAckTimeout, 2000}}});
  out.push_back({"ack_timeout_700",
                 "The ack timeout takes 700 ticks (110).",
                 always(as_stated),
                 false,
                 {{ParameterId::kAckTimeout, 700}}});
  out.push_back({"join_period_1024",
                 "A second from one join_request to the next (133).",
                 always(as_stated),
                 false,
                 {{ParameterId::kJoinPeriod, 1024}}});
  out.push_back({"join_period_400",
                 "A shorter join timer (133).",
                 always(as_stated),
                 false,
                 {{ParameterId::kJoinPeriod, 400}}});
  out.push_back({"chooses_for_350",
                 "Chooses among offers for 350 ticks (125).",
                 late(350, is_reply),
                 false,
                 {{ParameterId::kResponse, 350}}});
  out.push_back({"response_450",
                 "All answers take 440 ticks (125).",
                 late(440),
                 true,
                 {{ParameterId::kResponse, 450}}});
  out.push_back({"response_100",
                 "All answers take 90 ticks (125).",
                 late(90),
                 true,
                 {{ParameterId::kResponse, 100}}});
  out.push_back({"synaptic_period_1000",
                 "A synaptic clock of a second (133).",
                 always(as_stated),
                 false,
                 {{ParameterId::kSynapticPeriod, 1000}}});
  out.push_back({"synaptic_period_400",
                 "A faster synaptic clock (133).",
                 always(as_stated),
                 false,
                 {{ParameterId::kSynapticPeriod, 400}}});
  out.push_back({"synaptic_phase_150",
                 "Motes tick further apart (121).",
                 always(as_stated),
                 false,
                 {{ParameterId::kSynapticPhase, 150}}});
  out.push_back({"backs_off",
                 "TinyOS's random back-off of up to 10 ms before a frame (128).",
                 backing_off(1, 10),
                 false,
                 {{ParameterId::kChannelAccess, 30}}});
  out.push_back({"all_stated",
                 "Everything at once (110, 121, 125, 128, 133).",
                 late_and_backing_off(330, 20),
                 true,
                 {{ParameterId::kResponse, 350},
                  {ParameterId::kJoinPeriod, 1024},
                  {ParameterId::kAckTimeout, 2500},
                  {ParameterId::kChannelAccess, 60},
                  {ParameterId::kSynapticPeriod, 800},
                  {ParameterId::kSynapticPhase, 40}}});
  return out;
}

}  // namespace rubric::mutants
