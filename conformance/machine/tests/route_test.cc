// The route of each message: every role, line, kind of destination and kind of source.
#include "conformance/machine/route.h"

#include <gtest/gtest.h>

#include <map>
#include <string>

namespace rubric::machine {

bool operator==(const Route& a, const Route& b) {
  return a.deliver == b.deliver && a.onward == b.onward && a.am_dest == b.am_dest &&
         a.requirement == b.requirement && a.delivered == b.delivered;
}
void PrintTo(const Route& route, std::ostream* out) {
  *out << (route.deliver ? "deliver, " : "") << "onward " << static_cast<int>(route.onward)
       << " am " << route.am_dest << " rule " << static_cast<int>(route.requirement)
       << " delivered by " << static_cast<int>(route.delivered);
}

namespace {

constexpr std::uint16_t kIsland = 11;
constexpr std::uint16_t kSinkAm = 1;

enum class Pid { kOwn, kForeign, kAll };
enum class Devid { kSelf, kOther, kBroadcast, kNull };
constexpr Pid kPids[] = {Pid::kOwn, Pid::kForeign, Pid::kAll};
constexpr Devid kDevids[] = {Devid::kSelf, Devid::kOther, Devid::kBroadcast, Devid::kNull};

constexpr std::uint16_t kOtherDevid = 9;
constexpr std::uint16_t kForeignIsland = 12;

Router router(Role role, bool is_member = true) {
  switch (role) {
    case Role::kMote: return {role, {kIsland, 5}, is_member, kSinkAm};
    case Role::kSink: return {role, {kIsland, 1}, true, kSinkAm};
    case Role::kBaseStation: break;
  }
  return {Role::kBaseStation, {kIsland, kNullDevid}, true, kSinkAm};
}

Address address(const Router& who, Pid pid, Devid devid) {
  const std::uint16_t pids[] = {kIsland, kForeignIsland, kBroadcastPid};
  const std::uint16_t devids[] = {who.own.devid, kOtherDevid, kBroadcastDevid, kNullDevid};
  return {pids[static_cast<int>(pid)], devids[static_cast<int>(devid)]};
}

Route up(ReqId delivered, ReqId why_not = ReqId::kNone) {
  return {true, Route::Onward::kNowhere, 0, why_not, delivered};
}
Route no(ReqId requirement) { return {false, Route::Onward::kNowhere, 0, requirement, {}}; }
Route radio(std::uint16_t am_dest, ReqId requirement, ReqId delivered = ReqId::kNone) {
  return {delivered != ReqId::kNone, Route::Onward::kRadio, am_dest, requirement, delivered};
}
Route serial(std::uint16_t am_dest, ReqId requirement, ReqId delivered = ReqId::kNone) {
  return {delivered != ReqId::kNone, Route::Onward::kSerial, am_dest, requirement, delivered};
}
Route peis(std::uint16_t island, ReqId requirement) {
  return {false, Route::Onward::kPeis, island, requirement, {}};
}

using To = std::pair<Pid, Devid>;
using Table = std::map<To, Route>;

// Rows: own island, another, all islands. Columns: itself, another device, broadcast, NULL.
Table table(const std::array<Route, 12>& routes) {
  Table all;
  std::size_t i = 0;
  for (const Pid pid : kPids) {
    for (const Devid devid : kDevids) all[{pid, devid}] = routes[i++];
  }
  return all;
}

void expect_received(const Router& who, Link from, Address src, const Table& expected) {
  for (const auto& [to, route] : expected) {
    // A base station's own devid is NULL: then both columns are the same.
    const Address dest = address(who, to.first, to.second);
    SCOPED_TRACE("dest " + std::to_string(dest.pid) + ":" + std::to_string(dest.devid) + " src " +
                 std::to_string(src.pid));
    EXPECT_EQ(route_received(who, from, dest, src), route);
  }
}
void expect_own(const Router& who, const Table& expected) {
  for (const auto& [to, route] : expected) {
    const Address dest = address(who, to.first, to.second);
    SCOPED_TRACE("dest " + std::to_string(dest.pid) + ":" + std::to_string(dest.devid));
    EXPECT_EQ(route_own(who, dest), route);
  }
}

const Address kSources[] = {
    {kIsland, 7}, {kIsland, kNullDevid}, {kForeignIsland, 7}, {kBroadcastPid, 7}};

TEST(RouteReceived, MoteOnRadio) {
  const Route mine = up("N5-DELIVER"_rule);
  const Route other = no("N5-OTHER"_rule);
  const Route foreign = no("N5-FOREIGN"_rule);
  const Table expected = table({mine, other, mine, other,            //
                                foreign, foreign, foreign, foreign,  //
                                mine, other, mine, other});
  for (const Address src : kSources) {
    expect_received(router(Role::kMote), Link::kRadio, src, expected);
  }
}

TEST(RouteReceived, MoteThatIsNoMemberIgnoresAll) {
  std::array<Route, 12> all;
  all.fill(no("J11-HEAR"_rule));
  for (const Address src : kSources) {
    expect_received(router(Role::kMote, false), Link::kRadio, src, table(all));
  }
}

TEST(RouteReceived, SinkOnRadio) {
  const Route mine = up("N6-DELIVER"_rule);
  const Route other = no("N6-OTHER"_rule);
  const Route up_the_line = serial(kAmBroadcast, "N6-FORWARD"_rule);
  const Route abroad = serial(kAmBroadcast, "N6-ROUTE"_rule);
  const Route collision = no("N6-COLLISION"_rule);
  for (const Address src : kSources) {
    const Route foreign = src.pid == kIsland ? abroad : collision;
    expect_received(router(Role::kSink), Link::kRadio, src,
                    table({mine, other, mine, up_the_line,      //
                           foreign, foreign, foreign, foreign,  //
                           mine, other, mine, other}));
  }
}

TEST(RouteReceived, SinkOnSerial) {
  const Route mine = up("N7-DELIVER"_rule);
  const Route both = radio(kAmBroadcast, "N7-RADIO"_rule, "N7-DELIVER"_rule);
  const Route onto_air = radio(kOtherDevid, "N7-RADIO"_rule);
  const Route back = no("N6-ONCE"_rule);
  const Route foreign = no("N7-FOREIGN"_rule);
  const Route foreign_devid = up("N7-DELIVER"_rule, "N7-FOREIGN"_rule);
  for (const Address src : kSources) {
    expect_received(router(Role::kSink), Link::kSerial, src,
                    table({mine, onto_air, both, back,                      //
                           foreign_devid, foreign, foreign_devid, foreign,  //
                           mine, onto_air, both, back}));
  }
}

TEST(RouteReceived, BaseStationOnSerial) {
  const Route mine = up("N8-DELIVER"_rule);
  const Route loop = no(ReqId::kNone);
  const Route abroad = peis(kForeignIsland, "N8-PEIS"_rule);
  for (const Address src : kSources) {
    expect_received(router(Role::kBaseStation), Link::kSerial, src,
                    table({mine, loop, mine, mine,          //
                           abroad, abroad, abroad, abroad,  //
                           mine, loop, mine, mine}));
  }
}

TEST(RouteReceived, BaseStationOnPeis) {
  const Route mine = up("N8-DELIVER"_rule);
  const Route down = serial(kSinkAm, "N8-INCOMING"_rule);
  const Route both = serial(kSinkAm, "N8-INCOMING"_rule, "N8-DELIVER"_rule);
  const Route loop = no("N8-LOOP"_rule);
  for (const Address src : kSources) {
    expect_received(router(Role::kBaseStation), Link::kPeis, src,
                    table({mine, down, both, mine,  //
                           loop, loop, loop, loop,  //
                           mine, no(ReqId::kNone), mine, mine}));
  }
}

TEST(RouteReceived, LinesThatANodeDoesNotHave) {
  std::array<Route, 12> all;
  all.fill(no(ReqId::kNone));
  const std::pair<Role, Link> kMissing[] = {{Role::kMote, Link::kSerial},
                                            {Role::kMote, Link::kPeis},
                                            {Role::kSink, Link::kPeis},
                                            {Role::kBaseStation, Link::kRadio}};
  for (const auto& [role, link] : kMissing) {
    for (const Address src : kSources) expect_received(router(role), link, src, table(all));
  }
}

TEST(RouteOwn, Mote) {
  const Route self = no("N4-SELF"_rule);
  const Route direct = radio(kOtherDevid, "N4-MOTE"_rule);
  const Route everyone = radio(kAmBroadcast, "N4-MOTE"_rule);
  const Route sink = radio(kSinkAm, "N4-SINK"_rule);
  expect_own(router(Role::kMote), table({self, direct, everyone, sink,  //
                                         sink, sink, sink, sink,        //
                                         everyone, everyone, everyone, sink}));
  EXPECT_EQ(route_own(router(Role::kMote), {kIsland, kLocalDevid}).requirement, "N4-SELF"_rule);
}

TEST(RouteOwn, MoteThatIsNoMemberSendsNothing) {
  std::array<Route, 12> all;
  all.fill(no("J11-SEND"_rule));
  expect_own(router(Role::kMote, false), table(all));
}

TEST(RouteOwn, Sink) {
  const Route self = no("N4-SELF"_rule);
  const Route direct = radio(kOtherDevid, "N4-MOTE"_rule);
  const Route everyone = radio(kAmBroadcast, "N4-MOTE"_rule);
  const Route pc = serial(kAmBroadcast, "N6-OWN"_rule);
  expect_own(router(Role::kSink), table({self, direct, everyone, pc,  //
                                         pc, pc, pc, pc,              //
                                         everyone, everyone, everyone, pc}));
}

TEST(RouteOwn, BaseStation) {
  const Route self = no("N4-SELF"_rule);
  const Route down = serial(kSinkAm, "N8-SERIAL"_rule);
  const Route abroad = peis(kForeignIsland, "N8-PEIS"_rule);
  expect_own(router(Role::kBaseStation), table({self, down, down, self,          //
                                                abroad, abroad, abroad, abroad,  //
                                                self, down, down, self}));
}

// Whatever the addresses: radio messages are for this island, and none is sent back.
TEST(RouteReceived, NeverBackWhereItCameFrom) {
  const std::uint16_t kSome[] = {0, 1, 5, 9, 11, 12, kNullDevid, kLocalPid, 0xFFFF};
  int checked = 0;
  for (const Role role : {Role::kMote, Role::kSink, Role::kBaseStation}) {
    for (const Link link : {Link::kRadio, Link::kSerial, Link::kPeis}) {
      for (const std::uint16_t pid : kSome) {
        for (const std::uint16_t devid : kSome) {
          for (const std::uint16_t src : kSome) {
            const Route route = route_received(router(role), link, {pid, devid}, {src, 7});
            const Route::Onward back[] = {Route::Onward::kRadio, Route::Onward::kSerial,
                                          Route::Onward::kPeis};
            EXPECT_NE(route.onward, back[static_cast<int>(link)]);
            EXPECT_EQ(route.deliver, route.delivered != ReqId::kNone);
            if (route.onward == Route::Onward::kRadio) {
              EXPECT_TRUE(pid == kIsland || pid == kBroadcastPid);
            }
            ++checked;
          }
        }
      }
    }
  }
  EXPECT_EQ(checked, 3 * 3 * 9 * 9 * 9);
}

}  // namespace
}  // namespace rubric::machine
